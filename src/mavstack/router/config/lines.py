"""The line of each key of a TOML file, for error texts: `tomllib` reports lines of syntax errors only.

The text was parsed by `tomllib` before, so it is valid. It is read again statement by statement: a statement
ends where `tomllib` accepts it, so strings and arrays of several lines need no parser of their own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

#: The path of a value: names of tables, keys, and indexes in arrays of tables.
KeyPath: TypeAlias = "tuple[str | int, ...]"

#: The last line of a statement over several lines contains one of these. Only after such a line the statement
#: is parsed: parsing it after each line of a long array would be slow.
_ENDS: Final = ("]", "}", '"""', "'''")


class LineFinder:
    """Finds the line of a key in the text of a valid TOML file."""

    def __init__(self, text: str) -> None:
        self._lines: dict[KeyPath, int] = {}
        self._sizes: dict[KeyPath, int] = {}
        import tomllib  # a router without a configuration file does not need this import

        table: KeyPath = ()
        for number, statement in _statements(text):
            content = tomllib.loads(statement)
            if statement.lstrip().startswith("["):
                table = self._enter(content)
                self._lines.setdefault(table, number)
            else:
                self._add(table, content, number)

    def line(self, path: KeyPath) -> int:
        """Return the line of a key, or of the innermost table around it that has one."""
        for length in range(len(path), -1, -1):
            if path[:length] in self._lines:
                return self._lines[path[:length]]
        return 1

    def _enter(self, header: Mapping[str, Any]) -> KeyPath:
        """Return the path of a table from its header, with the index of the newest element of each array."""
        path: KeyPath = ()
        content: Any = header
        while isinstance(content, dict) and content:
            name = next(iter(content))
            path, content = (*path, name), content[name]
            if isinstance(content, list):
                self._sizes[path] = self._sizes.get(path, 0) + 1
            if path in self._sizes:
                path = (*path, self._sizes[path] - 1)
        return path

    def _add(self, table: KeyPath, content: object, number: int) -> None:
        """Add the line of all keys of a statement."""
        entries: Iterator[tuple[str | int, object]] = iter(())
        if isinstance(content, dict):
            entries = iter(content.items())
        elif isinstance(content, list):
            entries = iter(enumerate(content))
        for name, value in entries:
            self._lines.setdefault((*table, name), number)
            self._add((*table, name), value, number)


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """Yield the headers and the assignments with the numbers of their first lines."""
    import tomllib

    pending: list[str] = []
    first = 1
    for number, line in enumerate(text.split("\n"), 1):
        if not pending:
            first = number
            if not line.strip() or line.lstrip().startswith("#"):
                continue
        pending.append(line)
        if len(pending) > 1 and not any(mark in line for mark in _ENDS):
            continue
        statement = "\n".join(pending)
        try:
            tomllib.loads(statement)
        except tomllib.TOMLDecodeError:
            continue
        yield first, statement
        pending = []
