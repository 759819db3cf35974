"""The compact tables that dialects are loaded from, and the small value that holds one.

A table is one line of header, then one line a message and one line an enum, each two JSON values with a
tab between: first the little that every program needs at once (the layout on the wire), then the rest,
which stays text until someone asks. `codec` turns definitions into such lines and back; this file is all
that an ordinary program loads, so it imports next to nothing: not even `typing`, which takes longer than
loading a table (type checkers know `TYPE_CHECKING` by its name).
"""

# ruff: noqa: PTH118, PTH120, PTH123, PTH208
# (importing pathlib takes longer than loading a table)
from __future__ import annotations

import json
import os
from functools import cache

from mavstack.errors import UnknownDialectError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Any, TypeAlias

#: id, name, CRC_EXTRA, base length, length, and [name, type, array length, offset, enum] a field.
MessageRow: TypeAlias = "list[Any]"

_TABLES = os.path.join(os.path.dirname(__file__), "tables")


class Table:
    """What one definition file says; each line is parsed when it is needed."""

    __slots__ = ("_enums", "_facts", "_parsed", "_rows", "header", "ids", "path")

    def __init__(self, lines: Iterable[str], path: str = "") -> None:
        header, *rest = lines
        self.header: dict[str, Any] = json.loads(header)
        self.path = path
        count = self.header["messages"]
        rows = [line.partition("\t") for line in rest]
        starts = [row[0].split(",", 2) for row in rows[:count]]
        #: Ids of the messages by their names.
        self.ids = {name[1:-1]: int(number[1:]) for number, name, _ in starts}
        self._rows = {number: row[0] for number, row in zip(self.ids.values(), rows, strict=False)}
        self._facts = {name: row[2] for name, row in zip(self.ids, rows, strict=False)}
        self._enums = {row[0]: row[2] for row in rows[count:]}
        self._parsed: dict[int, MessageRow] = {}

    @property
    def name(self) -> str:
        """The name of the file, without `.xml`."""
        return str(self.header["name"])

    @property
    def includes(self) -> tuple[str, ...]:
        """The files it includes, as it names them."""
        return tuple(self.header["includes"])

    @property
    def enum_names(self) -> Iterable[str]:
        """The official names of the enums that the file defines or adds to."""
        return self._enums.keys()

    @property
    def rows(self) -> list[MessageRow]:
        """The rows of all messages."""
        rows: list[MessageRow] = json.loads(f"[{','.join(self._rows.values())}]")
        return rows

    def row(self, number: int) -> MessageRow:
        """The row of one message, always the same object."""
        row = self._parsed.get(number)
        if row is None:
            row = self._parsed[number] = json.loads(self._rows[number])
        return row

    def message_facts(self, name: str) -> list[Any]:
        """What a message's row leaves out."""
        facts: list[Any] = json.loads(self._facts[name])
        return facts

    def enum_row(self, name: str) -> list[Any]:
        """An enum: facts, and [value, name, facts] an entry."""
        row: list[Any] = json.loads(self._enums[name])
        return row


@cache
def official_names() -> tuple[str, ...]:
    """The official dialects, as their files are spelled."""
    names = (name.removesuffix(".jsonl") for name in os.listdir(_TABLES) if name.endswith(".jsonl"))
    return tuple(sorted(names, key=str.lower))


def official_name(name: str) -> str:
    """The official spelling of a dialect, whatever the case: `asluav` is ASLUAV."""
    wanted = name.lower().removesuffix(".xml")
    for known in official_names():
        if known.lower() == wanted:
            return known
    known_names = ", ".join(official_names())
    raise UnknownDialectError(f"no dialect is called {name!r}; there are {known_names}")


@cache
def load_table(name: str) -> Table:
    """The table of an official dialect."""
    with open(os.path.join(_TABLES, f"{name}.jsonl"), encoding="utf-8") as file:
        return Table(file.read().rstrip("\n").split("\n"))
