"""Field values for comparisons: zeros, extremes and random values, in the form of both peers."""

from __future__ import annotations

import codecs
import math
import random
import struct
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.dialects.model import FieldDefinition

#: struct codes of the numeric wire types.
CODES = {
    "uint8_t": "B",
    "uint8_t_mavlink_version": "B",
    "int8_t": "b",
    "uint16_t": "H",
    "int16_t": "h",
    "uint32_t": "I",
    "int32_t": "i",
    "uint64_t": "Q",
    "int64_t": "q",
    "float": "f",
    "double": "d",
}
CASES = ("zero", "lowest", "highest", "base only", "random", "random again", "half")
_TEXTS = (b"", b"a", b"one\0junk", "Höhe 12 µm".encode(), b"\xff\xfe", b"\xc3")


def limits(kind: str) -> tuple[Any, Any]:
    """Return the minimum and maximum of a type."""
    code = CODES[kind]
    if code in "fd":
        largest = struct.unpack("<" + code, {"f": b"\xff\xff\x7f\x7f", "d": b"\xff" * 6 + b"\xef\x7f"}[code])[
            0
        ]
        return -largest, largest
    bits = 8 * struct.calcsize(code)
    return (0, 2**bits - 1) if code.isupper() else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _float(rng: random.Random, code: str) -> float:
    choice = rng.random()
    if choice < 0.1:
        return rng.choice((math.nan, -math.nan, math.inf, -math.inf, -0.0))
    size = struct.calcsize(code)
    while True:
        pattern = rng.randbytes(size)
        value = struct.unpack("<" + code, pattern)[0]
        # A signalling NaN becomes a quiet one in a register, so no peer preserves it.
        if not math.isnan(value) or struct.pack("<" + code, value) == pattern:
            return value


def _number(rng: random.Random, kind: str, case: str) -> Any:
    low, high = limits(kind)
    if case == "lowest":
        return low
    if case == "highest":
        return high
    if case == "zero":
        return 0
    return _float(rng, CODES[kind]) if CODES[kind] in "fd" else rng.randint(low, high)


def _text(rng: random.Random, length: int, case: str) -> bytes:
    if case == "zero":
        return b""
    if case == "lowest":
        return b"\x01" * length
    if case == "highest":
        return b"\x7f" * length
    full = bytes(rng.randrange(1, 128) for _ in range(length))
    return rng.choice((*_TEXTS, full))[:length]


def field_value(rng: random.Random, field: FieldDefinition, case: str) -> Any:
    """Return a value of one field in the form of mavstack (texts as bytes)."""
    if case == "base only":
        case = "zero" if field.extension else "random"
    if case == "half":
        case = rng.choice(("zero", "random"))
    if field.type == "char":
        return _text(rng, field.array_length or 1, case)
    if not field.array_length:
        return _number(rng, field.type, case)
    numbers = [_number(rng, field.type, case) for _ in range(field.array_length)]
    return bytes(numbers) if field.type.startswith("uint8_t") else tuple(numbers)


def field_values(message: type[Message], case: str, seed: object = "") -> dict[str, Any]:
    """Return reproducible values of all fields of a message by name."""
    rng = random.Random(f"{seed}/{message.__name__}/{case}")
    return {field.name: field_value(rng, field, case) for field in message.definition.fields}


def random_message(message: type[Message], case: str = "random", seed: object = "") -> Message:
    """Create a message with the given field values."""
    return message(*field_values(message, case, seed).values())


def comparable(value: Any, kind: str) -> Any:
    """Convert a value to a form for which `==` means equal bytes on the wire."""
    if isinstance(value, bytes | tuple | list):
        return [comparable(element, kind) for element in value]
    if CODES[kind] in "fd":
        return struct.pack("<" + CODES[kind], value)
    return int(value)


def text_of(raw: bytes) -> str:
    """Decode the bytes of a text field."""
    # A truncated character at the end is dropped.
    return codecs.getincrementaldecoder("utf-8")("replace").decode(raw.split(b"\0", 1)[0])
