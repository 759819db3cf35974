"""The compact tables from which dialects are loaded.

A table is a header line, then one line per message and per enum. Each line has two JSON values separated by a
tab: first the layout on the wire, which every program needs, then the other metadata, which is read on
demand. `codec` converts definitions to such lines and back. This module is all that an ordinary program
loads, so it avoids imports, even that of `typing`, which takes longer than loading a table (type checkers
recognise `TYPE_CHECKING` by its name).
"""

# ruff: noqa: PTH118, PTH120, PTH123, PTH208
# (importing pathlib takes longer than loading a table)
from __future__ import annotations

import json
import os
from functools import cache, partial

from mavstack.errors import UnknownDialectError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from typing import Any, TypeAlias

#: The row of a message: id, name, CRC_EXTRA, base length, length, and for each field [name, type, array
#: length, offset, enum].
MessageRow: TypeAlias = "list[Any]"

_TABLES = os.path.join(os.path.dirname(__file__), "tables")


class Table:
    """The table of one definition file; lines are parsed on demand.

    Only the layouts stay in memory: a router, which uses no enums and descriptions, needs no more.

    Args:
        read: Returns the lines; called again when metadata or enums are used for the first time.
        path: Path of a user's file.
    """

    __slots__ = ("_details", "_parsed", "_read", "_rows", "header", "ids", "path")

    def __init__(self, read: Callable[[], Iterable[str]], path: str = "") -> None:
        header, *rest = read()
        self.header: dict[str, Any] = json.loads(header)
        self.path = path
        self._read = read
        rows = [line.partition("\t")[0] for line in rest[: self.header["messages"]]]
        starts = [row.split(",", 2) for row in rows]
        #: Message ids by name.
        self.ids = {name[1:-1]: int(number[1:]) for number, name, _ in starts}
        self._rows = dict(zip(self.ids.values(), rows, strict=True))
        self._details: tuple[dict[str, str], dict[str, str]] | None = None
        self._parsed: dict[int, MessageRow] = {}

    @property
    def _metadata(self) -> dict[str, str]:
        return self._read_details()[0]

    @property
    def _enums(self) -> dict[str, str]:
        return self._read_details()[1]

    def _read_details(self) -> tuple[dict[str, str], dict[str, str]]:
        """Return the metadata of messages and the enums by name."""
        if self._details is None:
            _, *lines = self._read()
            metadata: dict[str, str] = {}
            enums: dict[str, str] = {}
            for start, _, text in (line.partition("\t") for line in lines):
                if start.startswith("["):
                    metadata[start.split(",", 2)[1][1:-1]] = text
                else:
                    enums[start] = text
            self._details = metadata, enums  # set both at once: other threads may read it
        return self._details

    @property
    def name(self) -> str:
        """Name of the definition file, without `.xml`."""
        return str(self.header["name"])

    @property
    def includes(self) -> tuple[str, ...]:
        """Names of the included files, as written in the file."""
        return tuple(self.header["includes"])

    @property
    def enum_names(self) -> Iterable[str]:
        """Names of the enums that the file defines or extends."""
        return self._enums.keys()

    def rows(self) -> Iterator[MessageRow]:
        """Yield the rows of all messages."""
        return map(json.loads, self._rows.values())

    def content(self) -> Iterator[str]:
        """Yield the messages and enums as lines of text, the same for equal definitions."""
        for lines in (self._rows, self._metadata, self._enums):
            yield from (f"{key}\t{text}" for key, text in lines.items())

    def row(self, number: int) -> MessageRow:
        """Return the row of a message, always the same object."""
        row = self._parsed.get(number)
        if row is None:
            row = self._parsed[number] = json.loads(self._rows[number])
        return row

    def message_metadata(self, name: str) -> list[Any]:
        """Return the metadata of a message that is not in its row."""
        metadata: list[Any] = json.loads(self._metadata[name])
        return metadata

    def enum_row(self, name: str) -> list[Any]:
        """Return the metadata of an enum, and [value, name, metadata] of each entry."""
        row: list[Any] = json.loads(self._enums[name])
        return row


@cache
def official_names() -> tuple[str, ...]:
    """Return the names of the official dialects."""
    names = (name.removesuffix(".jsonl") for name in os.listdir(_TABLES) if name.endswith(".jsonl"))
    return tuple(sorted(names, key=str.lower))


def official_name(name: str) -> str:
    """Return the name of an official dialect in its official case: ASLUAV for `asluav`."""
    lower_name = name.lower().removesuffix(".xml")
    for known in official_names():
        if known.lower() == lower_name:
            return known
    known_names = ", ".join(official_names())
    raise UnknownDialectError(f"unknown dialect {name!r}; official dialects: {known_names}")


@cache
def load_table(name: str) -> Table:
    """Return the table of an official dialect."""
    return Table(partial(_lines, os.path.join(_TABLES, f"{name}.jsonl")))


def _lines(path: str) -> list[str]:
    with open(path, encoding="utf-8") as file:
        return file.read().rstrip("\n").split("\n")
