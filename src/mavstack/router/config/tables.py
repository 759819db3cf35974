"""Typed reading of the tables of a TOML file: each error has the file, the line, and what to do.

A reader takes the keys that it knows; `finish` then refuses the others, with a suggestion.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NoReturn, TypeVar

from mavstack.errors import RouterConfigError
from mavstack.router.config.lines import LineFinder

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from mavstack.router.config.lines import KeyPath

Value = TypeVar("Value")

#: Maximum size of a configuration file in bytes.
MAX_FILE_SIZE: Final = 1 << 20
_NAMES: Final = {
    str: "a text in quotes",
    bool: "true or false",
    int: "an integer",
    list: "a list",
    dict: "a table",
}


class ConfigText:
    """The text of a file, and its name in error texts."""

    def __init__(self, text: str, path: str) -> None:
        self._text = text
        self.path = path
        self._lines: LineFinder | None = None

    def error(self, keys: KeyPath, problem: str) -> RouterConfigError:
        """Return the error about a key."""
        if not self._text:
            return RouterConfigError(problem)
        if self._lines is None:
            self._lines = LineFinder(self._text)
        return RouterConfigError(problem, self.path, self._lines.line(keys))


class Table:
    """One table of a configuration.

    Attributes:
        keys: The path of the table in the file.
    """

    def __init__(self, values: Mapping[str, Any], source: ConfigText, keys: KeyPath = ()) -> None:
        self._values = values
        self._source = source
        self.keys = keys
        self._known: dict[str, None] = {}

    @classmethod
    def parse(cls, text: str, path: str) -> Table:
        """Parse the text of a file.

        Args:
            text: The TOML.
            path: Name of the file in error texts.

        Raises:
            RouterConfigError: The text is not TOML.
        """
        import tomllib  # a router without a configuration file does not need this import

        try:
            # The line finder expects \n at line ends, not \r\n as on Windows.
            return cls(tomllib.loads(text), ConfigText(text.replace("\r\n", "\n"), path))
        except tomllib.TOMLDecodeError as error:
            raise _syntax_error(str(error), path, text) from None
        except RecursionError:
            raise RouterConfigError("not TOML: nested too deeply", path) from None

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Table:
        """Return a table of values that come from no file, such as a request's."""
        return cls(values, ConfigText("", ""))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Table) and self._values == other._values

    __hash__ = None  # type: ignore[assignment]

    def has(self, key: str) -> bool:
        """Return whether the table has a key, which thereby is a known one."""
        self._known[key] = None
        return key in self._values

    def value(self, key: str, kind: type[Value], default: Value) -> Value:
        """Return the value of a key.

        Args:
            key: The key.
            kind: The type that the value must have.
            default: The value of a missing key.

        Raises:
            RouterConfigError: The value has another type.
        """
        if not self.has(key):
            return default
        found = self._values[key]
        if not isinstance(found, kind) or (isinstance(found, bool) and kind is not bool):
            self.refuse(key, f"must be {_NAMES[kind]}, got {_shown(found)}")
        return found

    def converted(self, key: str, convert: Callable[[Any], Value], default: Value) -> Value:
        """Return the value of a key as `convert` returns it; its ValueError says what is valid."""
        if not self.has(key):
            return default
        found = self._values[key]
        try:
            return convert(found)
        except ValueError as error:
            self.refuse(key, f"must be {error}, got {_shown(found)}")

    def choice(self, key: str, choices: Sequence[str]) -> str:
        """Return one of several words; the first is the default."""
        found = self.value(key, str, choices[0])
        if found not in choices:
            self.refuse(key, f"must be one of {', '.join(choices)}, got {_shown(found)}")
        return found

    def members(self, key: str, convert: Callable[[Any], Value]) -> tuple[Value, ...]:
        """Return a list, each element as `convert` returns it; empty if the key is missing.

        Raises:
            RouterConfigError: The value is not a list, is empty, or an element is not valid.
        """
        if not self.has(key):
            return ()
        found = self.value(key, list, [])
        if not found:
            self.refuse(key, "is empty: leave it out")
        try:
            return tuple(convert(each) for each in found)
        except ValueError as error:
            self.refuse(key, f"is not valid: {error}")

    def table(self, key: str) -> Table:
        """Return a table of this table; an empty one if it is missing."""
        return Table(self.value(key, dict, {}), self._source, (*self.keys, key))

    def tables(self, key: str) -> Iterator[Table]:
        """Yield the tables of an array of tables (`[[…]]`)."""
        for index, each in enumerate(self.value(key, list, [])):
            if not isinstance(each, dict):
                self.refuse(key, f"must be a list of tables, got {_shown(each)}")
            yield Table(each, self._source, (*self.keys, key, index))

    def named_tables(self, key: str) -> Iterator[tuple[str, Table]]:
        """Yield the tables `[key.NAME]` with their names."""
        outer = self.table(key)
        for name in self.value(key, dict, {}):
            yield name, outer.table(name)

    def names(self) -> Iterator[str]:
        """Yield all keys, which thereby are known ones."""
        for key in self._values:
            self._known[key] = None
            yield key

    def finish(self) -> None:
        """Refuse the keys that were not read.

        Raises:
            RouterConfigError: There is such a key; the text suggests one that exists.
        """
        from difflib import get_close_matches

        for key in self._values:
            if key not in self._known:
                near = get_close_matches(key, self._known, n=1)
                known = ", ".join(sorted(self._known))
                hint = f"did you mean {near[0]}?" if near else f"known keys: {known}"
                raise self._source.error((*self.keys, key), f"{self._place(key)} is unknown; {hint}")

    def refuse(self, key: str, problem: str) -> NoReturn:
        """Raise the error about a key; an empty key stands for the whole table."""
        keys = (*self.keys, key) if key else self.keys
        raise self._source.error(keys, f"{self._place(key)} {problem}")

    def _place(self, key: str) -> str:
        parts = [str(each) if isinstance(each, str) else f"[{each + 1}]" for each in self.keys]
        return ".".join(filter(None, [*parts, key])).replace(".[", "[") or "the file"


def _shown(value: object) -> str:
    text = repr(value) if not isinstance(value, bool) else str(value).lower()
    return text if len(text) <= 60 else f"{text[:57]}…"


def _syntax_error(problem: str, path: str, text: str) -> RouterConfigError:
    """Return the error for invalid TOML, whose text ends in `(at line 3, column 5)`."""
    message, _, place = problem.partition(" (at ")
    digits = place.removeprefix("line ").partition(",")[0]
    line = int(digits) if digits.isdecimal() else text.count("\n") + 1
    return RouterConfigError(f"not valid TOML: {message[:1].lower()}{message[1:]}", path, line)
