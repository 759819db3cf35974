"""Fields of PX4's topics, parsed from tables.

A line is a field: type, name, and in brackets the number of elements. A value after `=` is constant in a
simulated vehicle, and is written in one piece with neighbouring constants.
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
    #: The value of a constant field; None for a variable field.
    constant: float | None

    @property
    def code(self) -> str:
        """The field as a struct format."""
        return (str(self.count) if self.count > 1 else "") + _CODES[self.type]

    @property
    def text(self) -> str:
        """The field as in a format message."""
        return f"{self.type}{f'[{self.count}]' if self.count > 1 else ''} {self.name};"

    @property
    def constant_bytes(self) -> bytes:
        """Bytes of a constant field."""
        value = self.constant or 0.0
        fitted = value if _CODES[self.type] in "fd" else int(value)
        return struct.pack("<" + self.code, *[fitted] * self.count)


class Topic:
    """A topic and its number in a log; `codes` and `pieces` describe the packing of its records."""

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
        #: The parts of a record in order: constant bytes, or None for a variable value.
        self.pieces: tuple[bytes | None, ...] = tuple(pieces)

    @property
    def header(self) -> bytes:
        """First bytes of each record: length, message type, topic."""
        return struct.pack("<HBH", struct.calcsize("<" + self.codes) + 2, ord("D"), self.number)

    @property
    def description(self) -> str:
        """Text of the format message."""
        return f"{self.name}:{''.join(field.text for field in self.fields)}"


def _piece(pieces: list[bytes | None], constant: bytes) -> str:
    """Append constant bytes; return their struct format."""
    if constant:
        pieces.append(constant)
    return f"{len(constant)}s" if constant else ""


def _field(line: str) -> Field:
    """Parse a line."""
    found = _FIELD.fullmatch(line)
    if found is None:
        raise ValueError(f"invalid field: {line!r}")
    kind, name, count, constant = found.groups()
    return Field(kind, name, int(count or 1), None if constant is None else float(constant))


def topics_of(tables: dict[str, str]) -> dict[str, Topic]:
    """Return the topics of a log, numbered in their order."""
    return {name: Topic(number, name, table) for number, (name, table) in enumerate(tables.items())}


def block_of(*topics: Topic) -> Block:
    """Return the block of several topics, each with its header."""
    codes = "".join("5s" + topic.codes for topic in topics)
    return Block(codes, [piece for topic in topics for piece in (topic.header, *topic.pieces)])
