"""ArduPilot's packed parameter file, `@PARAM/param.pck`: all parameters in one compact file.

    header      magic u16 · parameters in this file u16 · parameters in all u16
    parameter   type and flags u8 · name lengths u8 · end of the name · value · default, if flag 1 is set

The low half of the first byte is the type (1 int8, 2 int16, 3 int32, 4 float), never 0; zero bytes before it
are padding, so that a value never crosses the border of two blocks, which may be read at different times. The
low half of the second byte is the number of characters shared with the name before, the high half the number
of characters that follow, less one. Defaults exist only under the second magic. An uploaded file has no
padding and no defaults, and its third number is its length in bytes.
"""

from __future__ import annotations

from dataclasses import dataclass
from struct import calcsize, pack, unpack_from
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.parameters.value import Parameter, Value, fitted, is_integer, name_field

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

PACKED_NAME = "@PARAM/param.pck"
MAGIC = 0x671B
MAGIC_WITH_DEFAULTS = 0x671C
HEADER_SIZE = 6
MAX_PARAMETERS = 65535
#: The largest size of an upload in bytes, which its header holds in 16 bits.
MAX_UPLOAD_SIZE = 65535

_KINDS = {
    1: (common.MavParamType.INT8, "<b"),
    2: (common.MavParamType.INT16, "<h"),
    3: (common.MavParamType.INT32, "<i"),
    4: (common.MavParamType.REAL32, "<f"),
}
_WIDER = {
    common.MavParamType.INT8: 1,
    common.MavParamType.UINT8: 2,
    common.MavParamType.INT16: 2,
    common.MavParamType.UINT16: 3,
}


@dataclass(frozen=True, slots=True)
class PackedFile:
    """The content of a packed file; `total` is the number of parameters of the vehicle."""

    parameters: tuple[Parameter, ...]
    defaults: dict[str, Value]
    total: int
    with_defaults: bool = False

    @property
    def complete(self) -> bool:
        """True if these are all parameters."""
        return len(self.parameters) == self.total


def unpack(data: bytes, *, start: int = 0) -> PackedFile | None:
    """Decode a packed file whose first parameter has the index `start`; None if it is damaged."""
    if len(data) < HEADER_SIZE:
        return None
    magic, number, total = unpack_from("<HHH", data)
    if magic not in (MAGIC, MAGIC_WITH_DEFAULTS):
        return None
    reader = _Reader(data, magic == MAGIC_WITH_DEFAULTS, start)
    while reader.skip_padding():
        if len(reader.parameters) >= number or not reader.read_entry():
            return None
    if len(reader.parameters) != number:
        return None
    if magic == MAGIC and total == len(data) != number:
        total = number  # in a file for upload this field holds the length of the file
    return PackedFile(tuple(reader.parameters), reader.defaults, total, reader.with_defaults)


def write(
    parameters: Sequence[Parameter],
    *,
    total: int | None = None,
    defaults: Mapping[str, Value] | None = None,
    block_size: int | None = None,
) -> bytes:
    """Encode parameters for download; `block_size` is the size of one read of the file."""
    _check_number(len(parameters))
    magic = MAGIC if defaults is None else MAGIC_WITH_DEFAULTS
    data = bytearray(pack("<HHH", magic, len(parameters), len(parameters) if total is None else total))
    last = ""
    for parameter in parameters:
        head, value = _entry(parameter, last, None if defaults is None else defaults.get(parameter.name))
        size = calcsize(_KINDS[head[0] & 15][1])
        data += b"\0" * _padding(len(data) + len(head) + len(value), size, block_size) + head + value
        last = parameter.name
    return bytes(data)


def write_upload(parameters: Sequence[Parameter]) -> bytes:
    """Encode parameters for upload in one file."""
    data = bytearray(write(parameters))
    if len(data) > MAX_UPLOAD_SIZE:
        raise InvalidArgumentError(f"a packed upload holds at most {MAX_UPLOAD_SIZE} bytes")
    data[4:6] = pack("<H", len(data))
    return bytes(data)


class _Reader:
    """The decoder of the entries of a file."""

    def __init__(self, data: bytes, with_defaults: bool, start: int) -> None:
        self.parameters: list[Parameter] = []
        self.defaults: dict[str, Value] = {}
        self.with_defaults = with_defaults
        self._data = data
        self._at = HEADER_SIZE
        self._start = start
        self._last = b""

    def skip_padding(self) -> bool:
        """Skip padding; return False at the end of the file."""
        rest = self._data[self._at :]
        self._at += len(rest) - len(rest.lstrip(b"\0"))
        return self._at < len(self._data)

    def read_entry(self) -> bool:
        """Decode one entry; return False if it is damaged."""
        head = self._data[self._at : self._at + 2]
        kind = _KINDS.get(head[0] & 15)
        if len(head) < 2 or kind is None:
            return False
        common_length, length = head[1] & 15, (head[1] >> 4) + 1
        end_of_name = self._at + 2 + length
        name = self._last[:common_length] + self._data[self._at + 2 : end_of_name]
        has_default = self.with_defaults and bool(head[0] & 16)
        end = end_of_name + calcsize(kind[1]) * (2 if has_default else 1)
        if end > len(self._data) or common_length > len(self._last) or len(name) > 16:
            return False
        self._store(name, kind, end_of_name, has_default)
        self._at, self._last = end, name
        return True

    def _store(self, raw: bytes, kind: tuple[common.MavParamType, str], at: int, has_default: bool) -> None:
        name = raw.decode(errors="replace")
        value: Value = unpack_from(kind[1], self._data, at)[0]
        index = self._start + len(self.parameters)
        self.parameters.append(Parameter(name, value, kind[0], index))
        if self.with_defaults:
            offset = calcsize(kind[1]) if has_default else 0
            self.defaults[name] = unpack_from(kind[1], self._data, at + offset)[0]


def _check_number(number: int) -> None:
    if number > MAX_PARAMETERS:
        raise InvalidArgumentError(f"a packed file holds at most {MAX_PARAMETERS} parameters")


def _kind_for(parameter: Parameter) -> int:
    """Return the file's type for a parameter; a float if no integer type fits."""
    kind = _WIDER.get(common.MavParamType(parameter.type))
    if kind is None and is_integer(parameter.type):
        kind = 3 if fitted(parameter.value, common.MavParamType.INT32) is not None else 4
    return kind or 4


def _entry(parameter: Parameter, last: str, default: Value | None) -> tuple[bytes, bytes]:
    name = name_field(parameter.name).encode()
    kind = _kind_for(parameter)
    shared = min(_shared(name, last.encode()), len(name) - 1, 15)
    value = _packed(parameter.value, kind)
    if default is not None:
        standard = _packed(default, kind)
        with_default = standard != value
        value += standard if with_default else b""
        kind |= 16 if with_default else 0
    return bytes((kind, shared | len(name) - shared - 1 << 4)) + name[shared:], value


def _shared(one: bytes, other: bytes) -> int:
    """Return the length of the common prefix of two names."""
    differences = (at for at, (a, b) in enumerate(zip(one, other, strict=False)) if a != b)
    return next(differences, min(len(one), len(other)))


def _packed(value: Value, kind: int) -> bytes:
    held = fitted(value, _KINDS[kind][0])
    if held is None:
        raise InvalidArgumentError(f"{value!r} does not fit into the parameter's type")
    return pack(_KINDS[kind][1], held)


def _padding(end: int, size: int, block_size: int | None) -> int:
    if block_size is None or size == 1:
        return 0
    beyond = end % block_size
    return size - beyond if 0 < beyond < size else 0
