"""The values in a frame: numbers of any size and byte order, texts, and arrays of numbers."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, Literal, NamedTuple, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Mapping

Endian: TypeAlias = Literal["little", "big"]
Value: TypeAlias = float | str | list[float | None]


class NumberType(NamedTuple):
    """A type of numbers: its bytes, and the character of `struct`, or whether an integer has a sign."""

    size: int
    code: str = ""
    signed: bool = False


INTEGERS: Final[Mapping[str, NumberType]] = MappingProxyType(
    {
        f"{'' if signed else 'u'}int{size * 8}": NumberType(size, signed=signed)
        for size in (1, 2, 3, 4, 8)
        for signed in (True, False)
    }
)
NUMBERS: Final[Mapping[str, NumberType]] = MappingProxyType(
    {**INTEGERS, "float16": NumberType(2, "e"), "float32": NumberType(4, "f"), "float64": NumberType(8, "d")}
)
TEXT: Final = "text"


@dataclass(frozen=True, slots=True)
class NumberPlace:
    """One number in a frame.

    Attributes:
        offset: Its first byte; negative: from the end of the frame.
        type: Its type.
        endian: Its byte order.
    """

    offset: int
    type: NumberType
    endian: Endian = "little"

    def read(self, frame: bytes, index: int = 0) -> float | int:
        """Return the number, or a later one of an array; the frame must be long enough."""
        start = (self.offset if self.offset >= 0 else len(frame) + self.offset) + index * self.type.size
        data = frame[start : start + self.type.size]
        if self.type.code:
            value: float = struct.unpack(("<" if self.endian == "little" else ">") + self.type.code, data)[0]
            return value
        return int.from_bytes(data, self.endian, signed=self.type.signed)


@dataclass(frozen=True, slots=True)
class FrameField:
    """A named value in a frame: `number * factor + add`.

    Attributes:
        name: The name.
        place: Where it is.
        size: The bytes that it takes; those of a text.
        count: The numbers of an array; 0: it is not an array.
        is_text: It is a text in UTF-8, which ends at a zero byte.
        bits: The first bit and the number of bits of an integer; None: all of them.
        names: Texts in place of numbers.
    """

    name: str
    place: NumberPlace
    size: int
    count: int = 0
    is_text: bool = False
    bits: tuple[int, int] | None = None
    factor: float = 1.0
    add: float = 0.0
    unit: str = ""
    names: Mapping[str, str] = field(default_factory=dict)

    def read(self, frame: bytes) -> Value | None:
        """Return the value; None if it is not a finite number."""
        if self.is_text:
            start = self.place.offset if self.place.offset >= 0 else len(frame) + self.place.offset
            return frame[start : start + self.size].partition(b"\0")[0].decode("utf-8", "replace")
        if not self.count:
            return self._convert(self.place.read(frame))
        return [self._scale(self.place.read(frame, index)) for index in range(self.count)]

    def is_inside(self, length: int, end: int) -> bool:
        """Return whether a frame has the value: before its checksum, unless it is counted from the end.

        Args:
            length: The bytes of the frame.
            end: The bytes before its checksum.
        """
        if self.place.offset >= 0:
            return self.place.offset <= end - self.size
        return 0 <= length + self.place.offset <= length - self.size

    def _convert(self, number: float) -> float | str | None:
        if self.bits is not None:
            first, count = self.bits
            number = int(number) >> first & (1 << count) - 1
        text = self.names.get(str(int(number))) if self.names else None
        if text is not None:
            return text
        return self._scale(number)

    def _scale(self, number: float) -> float | None:
        value = float(number) * self.factor + self.add
        return value if isfinite(value) else None
