"""The fields of PX4's topics, read from tables.

A line is a field: type, name, and in brackets how many there are. What stands behind `=` is always so in a
simulated vehicle, and is written as one piece with its neighbours.
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass

from mavstack.sim.storage.packing import Block

_CODES = {
    "uint64_t": "Q", "int64_t": "q", "uint32_t": "I", "int32_t": "i", "uint16_t": "H", "int16_t": "h",
    "uint8_t": "B", "int8_t": "b", "float": "f", "double": "d", "bool": "?", "char": "c",
}  # fmt: skip
_FIELD = re.compile(r"(\w+) (\w+)(?:\[(\d+)\])?(?: = (\S+))?")


@dataclass(frozen=True, slots=True)
class Field:
    """One field of a topic."""

    type: str
    name: str
    count: int
    #: Its value, where it never changes.
    constant: float | None

    @property
    def code(self) -> str:
        """As a struct format."""
        return (str(self.count) if self.count > 1 else "") + _CODES[self.type]

    @property
    def text(self) -> str:
        """As a log describes it."""
        return f"{self.type}{f'[{self.count}]' if self.count > 1 else ''} {self.name};"

    @property
    def constant_bytes(self) -> bytes:
        """Its bytes, where they never change."""
        value = self.constant or 0.0
        fitted = value if _CODES[self.type] in "fd" else int(value)
        return struct.pack("<" + self.code, *[fitted] * self.count)


class Topic:
    """A topic and its number in a log; `codes` and `pieces` are how its records are packed."""

    def __init__(self, number: int, name: str, table: str) -> None:
        self.number = number
        self.name = name
        self.fields = tuple(_field(line.strip()) for line in table.strip().splitlines())
        pieces: list[bytes | None] = []
        codes, constant = "", b""
        for field in self.fields:
            if field.constant is None:
                codes, constant = codes + _piece(pieces, constant) + field.code, b""
                pieces += [None] * field.count
            else:
                constant += field.constant_bytes
        self.codes = codes + _piece(pieces, constant)
        #: Where a record has constant bytes; None where there is a value.
        self.pieces: tuple[bytes | None, ...] = tuple(pieces)

    @property
    def head(self) -> bytes:
        """What each record begins with: its length, that it is data, whose."""
        return struct.pack("<HBH", struct.calcsize("<" + self.codes) + 2, ord("D"), self.number)

    @property
    def description(self) -> str:
        """As a format message gives it."""
        return f"{self.name}:{''.join(field.text for field in self.fields)}"


def _piece(pieces: list[bytes | None], constant: bytes) -> str:
    if constant:
        pieces.append(constant)
    return f"{len(constant)}s" if constant else ""


def _field(line: str) -> Field:
    found = _FIELD.fullmatch(line)
    if found is None:
        raise ValueError(f"{line!r} is no field")
    kind, name, count, constant = found.groups()
    return Field(kind, name, int(count or 1), None if constant is None else float(constant))


def topics_of(tables: dict[str, str]) -> dict[str, Topic]:
    """The topics of a log, numbered in their order."""
    return {name: Topic(number, name, table) for number, (name, table) in enumerate(tables.items())}


def block_of(*topics: Topic) -> Block:
    """The records of these topics one behind the other, each with its head."""
    codes = "".join("5s" + topic.codes for topic in topics)
    return Block(codes, [piece for topic in topics for piece in (topic.head, *topic.pieces)])
