"""How the fields of MSP messages stand in a payload: numbers, texts, lists and records.

A codec is a fact about a field, and it works in both directions: `decode` takes bytes from a
`PayloadReader`, `encode` appends bytes to a `PayloadWriter`. All numbers are little-endian. A number may be
scaled, so that a field has a usual unit: 12.6 V where the payload holds 126.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import TYPE_CHECKING, Any, Protocol

from mavstack.errors import InvalidArgumentError, InvalidTypeError

if TYPE_CHECKING:
    from mavstack.msp.firmware_info import FirmwareInfo

NumberKind = type[IntEnum | IntFlag | bool] | None

_SIZES = {"u8": 1, "i8": 1, "u16": 2, "i16": 2, "u32": 4, "i32": 4}
_FORMATS = {"u8": "B", "i8": "b", "u16": "H", "i16": "h", "u32": "I", "i32": "i"}


class PayloadTooShortError(Exception):
    """A payload ends inside a field; `missing` bytes are not there."""

    def __init__(self, missing: int) -> None:
        super().__init__(missing)
        self.missing = missing


class PayloadReader:
    """The bytes of a payload that are not decoded yet, and the firmware that sent them."""

    __slots__ = ("_offset", "_payload", "firmware", "values")

    def __init__(self, payload: bytes, firmware: FirmwareInfo | None = None) -> None:
        self._payload = payload
        self._offset = 0
        self.firmware = firmware
        self.values: dict[str, Any] = {}  # the fields decoded so far

    @property
    def remaining(self) -> int:
        """Number of bytes that are not decoded yet."""
        return len(self._payload) - self._offset

    def take(self, count: int) -> bytes:
        """Return the next bytes.

        Args:
            count: Number of bytes.

        Raises:
            PayloadTooShortError: The payload ends earlier.
        """
        if count > self.remaining:
            raise PayloadTooShortError(count - self.remaining)
        self._offset += count
        return self._payload[self._offset - count : self._offset]


class PayloadWriter(bytearray):
    """The bytes of a payload that is being encoded, and the firmware that receives them."""

    firmware: FirmwareInfo | None = None
    message: object = None  # the message whose fields are encoded


class Codec(Protocol):
    """One kind of field."""

    @property
    def wire_type(self) -> str:
        """The type in the payload, such as "i16" or "u8[]"."""

    def decode(self, reader: PayloadReader) -> object:
        """Take the value of the field from a payload."""

    def encode(self, value: object, payload: PayloadWriter) -> None:
        """Append the value of the field to a payload."""


@dataclass(frozen=True, slots=True)
class Number:
    """An integer, which means `(offset + raw * step) / per_unit`."""

    wire_type: str
    per_unit: float = 1
    step: int = 1
    offset: int = 0
    kind: NumberKind = None

    @property
    def size(self) -> int:
        """Number of bytes in the payload."""
        return _SIZES[self.wire_type]

    @property
    def format(self) -> str:
        """The character of the type in a format of `struct`."""
        return _FORMATS[self.wire_type]

    @property
    def signed(self) -> bool:
        """True if negative numbers are possible."""
        return self.wire_type[0] == "i"

    @property
    def limits(self) -> tuple[float, float]:
        """The smallest and the largest value, in the unit of the field."""
        bits = 8 * self.size
        low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if self.signed else (0, (1 << bits) - 1)
        return self._scaled(low), self._scaled(high)

    def _scaled(self, raw: int) -> float:
        stepped = self.offset + raw * self.step
        return stepped if self.per_unit == 1 else stepped / self.per_unit

    def value(self, raw: int) -> object:
        """Return the value of a number in the payload."""
        if self.kind is None:
            return self._scaled(raw)
        try:
            return self.kind(raw)
        except ValueError:
            return raw

    def decode(self, reader: PayloadReader) -> object:
        """Take the value of the field from a payload."""
        return self.value(int.from_bytes(reader.take(self.size), "little", signed=self.signed))

    def encode(self, value: object, payload: PayloadWriter) -> None:
        """Append the value of the field to a payload."""
        if not isinstance(value, (int, float)):
            raise InvalidTypeError(f"must be a number, got {value!r}")
        low, high = self.limits
        if not math.isfinite(value) or not low <= value <= high:
            raise InvalidArgumentError(f"must be between {low:g} and {high:g}, got {value!r}")
        raw = round((value * self.per_unit - self.offset) / self.step)
        payload += raw.to_bytes(self.size, "little", signed=self.signed)


@dataclass(frozen=True, slots=True)
class ByVariant:
    """A field that iNav sends in another type than Betaflight."""

    betaflight: Codec
    inav: Codec

    @property
    def wire_type(self) -> str:
        """The types in the payload."""
        return f"{self.betaflight.wire_type} ({self.inav.wire_type} in iNav)"

    def decode(self, reader: PayloadReader) -> object:
        """Take the value of the field from a payload."""
        return self._of(reader.firmware).decode(reader)

    def encode(self, value: object, payload: PayloadWriter) -> None:
        """Append the value of the field to a payload."""
        self._of(payload.firmware).encode(value, payload)

    def _of(self, firmware: FirmwareInfo | None) -> Codec:
        return self.inav if firmware is not None and firmware.is_inav else self.betaflight


@dataclass(frozen=True, slots=True)
class Text:
    """A text of a fixed length, filled up with `fill`."""

    length: int
    fill: str = "\0"

    @property
    def wire_type(self) -> str:
        """The type in the payload."""
        return f"char[{self.length}]"

    def decode(self, reader: PayloadReader) -> str:
        """Take the text from a payload, without what fills it up."""
        return _to_text(reader.take(self.length)).rstrip(self.fill + "\0")

    def encode(self, value: object, payload: PayloadWriter) -> None:
        """Append the text to a payload."""
        data = _to_bytes(value, self.length)
        payload += data + self.fill.encode() * (self.length - len(data))


@dataclass(frozen=True, slots=True)
class PrefixedText:
    """A text behind a byte with its length; shorter ones are filled up to `length` if that is not 0."""

    length: int = 0
    fill: str = " "

    @property
    def wire_type(self) -> str:
        """The type in the payload."""
        return "u8 + char[]"

    def decode(self, reader: PayloadReader) -> str:
        """Take the text from a payload, without what fills it up."""
        data = _to_text(reader.take(reader.take(1)[0]))
        return data.rstrip(self.fill + "\0") if self.length else data

    def encode(self, value: object, payload: PayloadWriter) -> None:
        """Append the length and the text to a payload."""
        data = _to_bytes(value, self.length or 255)
        data += self.fill.encode() * (self.length - len(data))
        payload += bytes([len(data)]) + data


@dataclass(frozen=True, slots=True)
class RestText:
    """A text up to the end of the payload."""

    @property
    def wire_type(self) -> str:
        """The type in the payload."""
        return "char[]"

    def decode(self, reader: PayloadReader) -> str:
        """Take the text from a payload, up to its first NUL."""
        return _to_text(reader.take(reader.remaining)).split("\0")[0]

    def encode(self, value: object, payload: PayloadWriter) -> None:
        """Append the text to a payload."""
        payload += _to_bytes(value, None)


@dataclass(frozen=True, slots=True)
class NameList:
    """Names up to the end of the payload, each followed by a semicolon."""

    @property
    def wire_type(self) -> str:
        """The type in the payload."""
        return "char[]"

    def decode(self, reader: PayloadReader) -> tuple[str, ...]:
        """Take the names from a payload."""
        return tuple(name for name in _to_text(reader.take(reader.remaining)).split(";") if name)

    def encode(self, value: object, payload: PayloadWriter) -> None:
        """Append the names to a payload."""
        for name in _sequence(value):
            payload += f"{name};".encode()


@dataclass(frozen=True, slots=True)
class Bytes:
    """Bytes that are not interpreted: `length` of them, or with None as many as there are."""

    length: int | None = None

    @property
    def wire_type(self) -> str:
        """The type in the payload."""
        return f"u8[{'' if self.length is None else self.length}]"

    def decode(self, reader: PayloadReader) -> bytes:
        """Take the bytes from a payload."""
        return reader.take(reader.remaining if self.length is None else self.length)

    def encode(self, value: object, payload: PayloadWriter) -> None:
        """Append the bytes to a payload."""
        data = _raw(value)
        if self.length is not None and len(data) != self.length:
            raise InvalidArgumentError(f"must have {self.length} bytes, got {len(data)}")
        payload += data


@dataclass(frozen=True, slots=True)
class CountedBytes:
    """Bytes behind a byte with their number."""

    @property
    def wire_type(self) -> str:
        """The type in the payload."""
        return "u8 + u8[]"

    def decode(self, reader: PayloadReader) -> bytes:
        """Take the bytes from a payload."""
        return reader.take(reader.take(1)[0])

    def encode(self, value: object, payload: PayloadWriter) -> None:
        """Append the number of bytes and the bytes to a payload."""
        data = _raw(value)
        payload += _count(len(data)) + data


@dataclass(frozen=True, slots=True)
class Items:
    """Several values of one kind.

    Their number is `count`, or stands in a byte before them (`counted`) or in an earlier field
    (`count_field`); otherwise they end where `leave` bytes or fewer are left of the payload.
    """

    item: Codec
    count: int | None = None
    counted: bool = False
    leave: int = 0
    count_field: str = ""

    @property
    def wire_type(self) -> str:
        """The type in the payload."""
        number = "" if self.count is None else str(self.count)
        return f"{'u8 + ' if self.counted else ''}{self.item.wire_type}[{number}]"

    def decode(self, reader: PayloadReader) -> tuple[object, ...]:
        """Take the values from a payload."""
        count = reader.take(1)[0] if self.counted else self.count
        if self.count_field:
            count = reader.values[self.count_field]
        if count is not None:
            return tuple(self.item.decode(reader) for _ in range(count))
        items = []
        while reader.remaining > self.leave:
            items.append(self.item.decode(reader))
        return tuple(items)

    def encode(self, value: object, payload: PayloadWriter) -> None:
        """Append the values to a payload."""
        items = _sequence(value)
        count = getattr(payload.message, self.count_field) if self.count_field else self.count
        if count is not None and len(items) != count:
            raise InvalidArgumentError(f"must have {count} values, got {len(items)}")
        if self.counted:
            payload += _count(len(items))
        for item in items:
            self.item.encode(item, payload)


def _count(number: int) -> bytes:
    if number > 255:
        raise InvalidArgumentError(f"must have at most 255 values, got {number}")
    return bytes([number])


def _sequence(value: object) -> Sequence[object]:
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise InvalidTypeError(f"must be a sequence, got {value!r}")
    return value


def _raw(value: object) -> bytes:
    if not isinstance(value, (bytes, bytearray)):
        raise InvalidTypeError(f"must be bytes, got {value!r}")
    return bytes(value)


def _to_text(data: bytes) -> str:
    return data.decode("utf-8", "replace")


def _to_bytes(value: object, limit: int | None) -> bytes:
    if not isinstance(value, str):
        raise InvalidTypeError(f"must be a text, got {value!r}")
    data = value.encode()
    if limit is not None and len(data) > limit:
        raise InvalidArgumentError(f"must have at most {limit} bytes, got {len(data)}")
    return data
