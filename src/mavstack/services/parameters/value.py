"""Parameters, and the encoding of their values in a float field (guide: parameter protocol).

There are two encodings, and a message does not tell which it uses. *Bytewise* stores the bytes of the value
in the float's place; nothing is lost, but 64-bit types do not fit and are cast. A *C cast* converts the value
to a float32, which holds integers only up to 24 bits. AUTOPILOT_VERSION tells which encoding a component
uses; if it tells both or none, ArduPilot casts and the others do not.

Bytewise values must never pass through a float: some integers are signalling NaNs, of which the processor
changes a bit. They are therefore read from the payload, where the float field comes first.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from math import isfinite, isnan
from struct import calcsize, pack, unpack
from typing import TYPE_CHECKING, TypeAlias, TypeVar

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.frames import as_float32

if TYPE_CHECKING:
    from mavstack.dialects import Message

#: `param_index` of a value that was not requested by index.
NO_INDEX = 65535
NAME_LENGTH = 16
#: The smallest integer from which neighbouring integers become the same float32.
CAST_LIMIT = 1 << 24
Value: TypeAlias = int | float

_FORMATS = {
    common.MavParamType.UINT8: "<B",
    common.MavParamType.INT8: "<b",
    common.MavParamType.UINT16: "<H",
    common.MavParamType.INT16: "<h",
    common.MavParamType.UINT32: "<I",
    common.MavParamType.INT32: "<i",
    common.MavParamType.UINT64: "<Q",
    common.MavParamType.INT64: "<q",
    common.MavParamType.REAL32: "<f",
    common.MavParamType.REAL64: "<d",
}
_REAL = frozenset({common.MavParamType.REAL32, common.MavParamType.REAL64})
FieldMessage = TypeVar("FieldMessage", common.ParamValue, common.ParamSet)


class Encoding(Enum):
    """The encoding of values in `param_value`."""

    BYTEWISE = "bytewise"
    C_CAST = "C cast"


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter as received from its component.

    Attributes:
        name: Its name.
        value: Its value.
        type: Its MAV_PARAM_TYPE.
        index: Its index in the component's table; None if unknown.
        exact: False if the encoding may have rounded the value.
    """

    name: str
    value: Value
    type: int = common.MavParamType.REAL32
    index: int | None = field(default=None, compare=False)
    exact: bool = field(default=True, compare=False)

    @property
    def text(self) -> str:
        """The value as text: a float32 with the fewest digits that convert back to it."""
        return shortest(self.value) if self.type == common.MavParamType.REAL32 else str(self.value)


def encoding_of(capabilities: int, autopilot: int) -> Encoding:
    """Return the encoding of a component, from AUTOPILOT_VERSION.capabilities and HEARTBEAT.autopilot."""
    bytewise = bool(capabilities & common.MavProtocolCapability.PARAM_ENCODE_BYTEWISE)
    cast = bool(capabilities & common.MavProtocolCapability.PARAM_ENCODE_C_CAST)
    if bytewise != cast:
        return Encoding.BYTEWISE if bytewise else Encoding.C_CAST
    return Encoding.C_CAST if autopilot == common.MavAutopilot.ARDUPILOTMEGA else Encoding.BYTEWISE


def is_integer(kind: int) -> bool:
    """Return whether a MAV_PARAM_TYPE holds integers; an unknown type counts as REAL32."""
    return kind in _FORMATS and kind not in _REAL


def is_known(kind: int) -> bool:
    """Return whether a number is a MAV_PARAM_TYPE."""
    return kind in _FORMATS


def limits(kind: int) -> tuple[int, int]:
    """Return the smallest and the largest value of an integer type."""
    bits = 8 * calcsize(_FORMATS[common.MavParamType(kind)])
    signed = _FORMATS[common.MavParamType(kind)][1].islower()
    return (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)


def fitted(value: Value, kind: int) -> Value | None:
    """Convert a value to a type; None if the type cannot hold it."""
    if kind == common.MavParamType.REAL64:
        return float(value)
    if not is_integer(kind):
        return float(unpack("<f", pack("<f", as_float32(value)))[0])
    if not isfinite(value) or int(value) != value:
        return None
    smallest, largest = limits(kind)
    return int(value) if smallest <= value <= largest else None


def as_type(name: str, value: Value, kind: int) -> Value:
    """Convert a value to a type; raises InvalidArgumentError if the type cannot hold it."""
    found = fitted(value, kind) if is_known(kind) else None
    if found is None:
        raise InvalidArgumentError(f"{name} is of type {type_name(kind)}, which cannot hold {value!r}")
    return found


def type_name(kind: int) -> str:
    """Return the name of a type: INT32."""
    return common.MavParamType(kind).name if is_known(kind) else f"MAV_PARAM_TYPE {kind}"


def same(one: Value, other: Value) -> bool:
    """Return whether two values are equal; NaN equals itself."""
    return one == other or (isnan(one) and isnan(other))


def encode(value: Value, kind: int, encoding: Encoding) -> bytes:
    """Encode a value into the four bytes of the field."""
    if encoding is Encoding.BYTEWISE and _lies_bytewise(kind) and is_integer(kind):
        return pack(_FORMATS[common.MavParamType(kind)], value).ljust(4, b"\0")
    return pack("<f", as_float32(value))


def decode(data: bytes, kind: int, encoding: Encoding) -> Value:
    """Decode the four bytes of the field; a cast beyond the type's limits is clamped."""
    if encoding is Encoding.BYTEWISE and _lies_bytewise(kind):
        layout = _FORMATS[common.MavParamType(kind)]
        found: Value = unpack(layout, data[: calcsize(layout)])[0]
        return found
    number = float(unpack("<f", data)[0])
    if not is_integer(kind):
        return number
    smallest, largest = limits(kind)
    return 0 if isnan(number) else int(min(max(number, smallest), largest))


def whole_bytes(value: Value, kind: int) -> bytes:
    """Encode a value into the bytes of its own type."""
    layout = _FORMATS[common.MavParamType(kind)]
    return pack(layout, as_float32(value) if layout == "<f" else value)


def is_exact(value: Value, kind: int, encoding: Encoding) -> bool:
    """Return whether a received value is certainly exact."""
    if encoding is Encoding.BYTEWISE and _lies_bytewise(kind):
        return True
    return abs(value) < CAST_LIMIT if is_integer(kind) else kind != common.MavParamType.REAL64


def survives(value: Value, kind: int, encoding: Encoding) -> bool:
    """Return whether the encoding preserves a value."""
    return same(decode(encode(value, kind, encoding), kind, encoding), value)


def name_field(name: str) -> str:
    """Return a parameter name if it is valid; else raise InvalidArgumentError."""
    if not 1 <= len(name.encode(errors="surrogateescape")) <= NAME_LENGTH or "\0" in name:
        raise InvalidArgumentError(f"a parameter name must have 1 to {NAME_LENGTH} bytes, got {name!r}")
    return name


def field_of(message: Message) -> bytes:
    """Return the unmodified bytes of `param_value` in a PARAM_VALUE or PARAM_SET."""
    return message.to_payload()[:4].ljust(4, b"\0")


def with_field(message: FieldMessage, data: bytes) -> FieldMessage:
    """Return a message with these bytes in `param_value`."""
    return message.from_payload(data + message.to_payload()[4:])


def read_value(message: common.ParamValue, encoding: Encoding) -> Parameter:
    """Return the parameter in a PARAM_VALUE."""
    kind = int(message.param_type)
    value = decode(field_of(message), kind, encoding)
    index = None if message.param_index >= max(message.param_count, 1) else message.param_index
    return Parameter(message.param_id, value, kind, index, is_exact(value, kind, encoding))


def shortest(value: Value) -> str:
    """Format a float32 with the fewest digits that convert back to it."""
    if not isfinite(value):
        return str(value)
    for digits in range(6, 9):
        text = f"{value:.{digits}g}"
        if pack("<f", as_float32(float(text))) == pack("<f", as_float32(value)):
            return text
    return f"{value:.9g}"


def _lies_bytewise(kind: int) -> bool:
    return kind in _FORMATS and calcsize(_FORMATS[common.MavParamType(kind)]) <= 4
