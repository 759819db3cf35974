"""Extended parameters, and the encoding of their values in 128 bytes (guide: extended parameter protocol).

Numbers are stored in their own bytes. The custom type is up to 128 bytes: usually text, with a NUL behind it
if it is shorter. In Python it is a `str` if it is text, and `bytes` otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isfinite
from struct import calcsize, pack, unpack_from
from typing import TYPE_CHECKING, TypeAlias, TypeVar

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.frames import as_float32

if TYPE_CHECKING:
    from mavstack.dialects import Message

VALUE_LENGTH = 128
ExtendedValue: TypeAlias = int | float | str | bytes

_FORMATS = {
    common.MavParamExtType.UINT8: "<B",
    common.MavParamExtType.INT8: "<b",
    common.MavParamExtType.UINT16: "<H",
    common.MavParamExtType.INT16: "<h",
    common.MavParamExtType.UINT32: "<I",
    common.MavParamExtType.INT32: "<i",
    common.MavParamExtType.UINT64: "<Q",
    common.MavParamExtType.INT64: "<q",
    common.MavParamExtType.REAL32: "<f",
    common.MavParamExtType.REAL64: "<d",
}
_OFFSETS = {common.ParamExtValue: 20, common.ParamExtSet: 18, common.ParamExtAck: 16}
FieldMessage = TypeVar("FieldMessage", common.ParamExtValue, common.ParamExtSet, common.ParamExtAck)


@dataclass(frozen=True, slots=True)
class ExtendedParameter:
    """An extended parameter as received from its component."""

    name: str
    value: ExtendedValue
    type: int = common.MavParamExtType.CUSTOM
    index: int | None = field(default=None, compare=False)


def usual_type(value: ExtendedValue) -> int:
    """Return the default type for a value."""
    if isinstance(value, str | bytes):
        return common.MavParamExtType.CUSTOM
    return common.MavParamExtType.INT32 if isinstance(value, int) else common.MavParamExtType.REAL32


def is_known(kind: int) -> bool:
    """Return whether a number is a MAV_PARAM_EXT_TYPE."""
    return kind in _FORMATS or kind == common.MavParamExtType.CUSTOM


def encode(value: ExtendedValue, kind: int) -> bytes:
    """Encode a value; raises InvalidArgumentError if the type cannot hold it."""
    data = _bytes_of(value, kind)
    if data is None or len(data) > VALUE_LENGTH:
        raise InvalidArgumentError(f"an extended parameter of type {kind} cannot hold {value!r}")
    return data.ljust(VALUE_LENGTH, b"\0")


def decode(data: bytes, kind: int) -> ExtendedValue:
    """Decode the bytes of the field; an unknown type is decoded like the custom one."""
    layout = _FORMATS.get(common.MavParamExtType(kind)) if is_known(kind) else None
    if layout is not None:
        number: int | float = unpack_from(layout, data)[0]
        return number
    content = data.rstrip(b"\0")
    try:
        text = content.decode()
    except UnicodeDecodeError:
        return content
    return content if "\0" in text else text


def field_of(message: Message) -> bytes:
    """Return the unmodified bytes of `param_value`."""
    begin = _OFFSETS[type(message)]
    return message.to_payload()[begin : begin + VALUE_LENGTH].ljust(VALUE_LENGTH, b"\0")


def with_field(message: FieldMessage, data: bytes) -> FieldMessage:
    """Return a message with these bytes in `param_value`."""
    begin = _OFFSETS[type(message)]
    payload = message.to_payload().ljust(begin + VALUE_LENGTH, b"\0")
    return message.from_payload(payload[:begin] + data + payload[begin + VALUE_LENGTH :])


def read_value(message: common.ParamExtValue) -> ExtendedParameter:
    """Return the parameter in a PARAM_EXT_VALUE."""
    kind = int(message.param_type)
    index = message.param_index if message.param_index < message.param_count else None
    return ExtendedParameter(message.param_id, decode(field_of(message), kind), kind, index)


def _bytes_of(value: ExtendedValue, kind: int) -> bytes | None:
    if kind == common.MavParamExtType.CUSTOM:
        return value.encode() if isinstance(value, str) else value if isinstance(value, bytes) else None
    if not is_known(kind) or isinstance(value, str | bytes):
        return None
    layout = _FORMATS[common.MavParamExtType(kind)]
    if layout[1] in "fd":
        return pack(layout, as_float32(value) if layout == "<f" else value)
    if not isfinite(value) or int(value) != value:
        return None
    bits, signed = 8 * calcsize(layout), layout[1].islower()
    smallest, beyond = (-(1 << bits - 1), 1 << bits - 1) if signed else (0, 1 << bits)
    return pack(layout, int(value)) if smallest <= value < beyond else None
