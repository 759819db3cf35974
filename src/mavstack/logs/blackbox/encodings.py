"""The encodings of numbers in Blackbox frames.

A reader takes the bytes of a flight, a position, the number of fields that share the encoding, and a list to
which it appends their values; it returns the position behind them. A read beyond the end raises `IndexError`.

`VB` is a number in groups of seven bits, the lowest ones first; the top bit says that another group follows.
Signed numbers are interleaved: 0, -1, 1, -2 … are 0, 1, 2, 3 … The other encodings put a few small numbers
behind a tag that says how many bits each of them has.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final, TypeAlias

Reader: TypeAlias = Callable[[bytes, int, int, list[int]], int]

SIGNED_VB, UNSIGNED_VB, NEGATIVE_14_BIT = 0, 1, 3
TAG8_8SVB, TAG2_3S32, TAG8_4S16, NOTHING, TAG2_3SVARIABLE = 6, 7, 8, 9, 10

#: Maximum number of bytes of a variable-length number (VB); a longer one is damaged and reads as 0.
_MAX_VB: Final = 5
_WORD: Final = 0xFFFF_FFFF


def unsigned_vb(data: bytes, position: int) -> tuple[int, int]:
    """Return a number and the position behind it."""
    byte = data[position]
    if byte < 128:
        return byte, position + 1
    value, shift = byte & 127, 7
    for place in range(position + 1, position + _MAX_VB):
        byte = data[place]
        value |= (byte & 127) << shift
        if byte < 128:
            return value & _WORD, place + 1
        shift += 7
    return 0, position + _MAX_VB


def signed_vb(data: bytes, position: int) -> tuple[int, int]:
    """Return a signed number and the position behind it."""
    value, position = unsigned_vb(data, position)
    return (value >> 1) ^ -(value & 1), position


def extended(value: int, bits: int) -> int:
    """Return the lowest bits of a value as a signed number."""
    sign = 1 << (bits - 1)
    return ((value & ((1 << bits) - 1)) ^ sign) - sign


#: Signed values by the unsigned number of 14 bits that encodes them (zigzag); and the three 2-bit numbers by
#: the tag byte of TAG2_3S32 or TAG2_3SVARIABLE.
SIGNED_VALUES: Final = tuple((bits >> 1) ^ -(bits & 1) for bits in range(1 << 14))
SMALL_TRIPLES: Final = tuple(tuple(extended(byte >> shift, 2) for shift in (4, 2, 0)) for byte in range(64))


def _read_unsigned(data: bytes, position: int, count: int, values: list[int]) -> int:
    for _ in range(count):
        byte = data[position]
        if byte < 128:
            values.append(byte)
            position += 1
        else:
            value, position = unsigned_vb(data, position)
            values.append(value)
    return position


def _read_signed(data: bytes, position: int, count: int, values: list[int]) -> int:
    for _ in range(count):
        value = data[position]
        if value < 128:
            position += 1
        else:
            value, position = unsigned_vb(data, position)
        values.append((value >> 1) ^ -(value & 1))
    return position


def _read_negative(data: bytes, position: int, count: int, values: list[int]) -> int:
    for _ in range(count):
        value, position = unsigned_vb(data, position)
        values.append(-extended(value, 14))
    return position


def _read_nothing(_data: bytes, position: int, count: int, values: list[int]) -> int:
    values.extend([0] * count)
    return position


def _read_tag8_8svb(data: bytes, position: int, count: int, values: list[int]) -> int:
    """Read up to eight numbers; the tag has a bit for each that is not 0. A single one has no tag."""
    if count == 1:
        return _read_signed(data, position, 1, values)
    tag = data[position]
    position += 1
    for _ in range(count):
        if tag & 1:
            value, position = signed_vb(data, position)
            values.append(value)
        else:
            values.append(0)
        tag >>= 1
    return position


def _read_sized(data: bytes, position: int, values: list[int]) -> int:
    """Read three numbers of one to four bytes, whose sizes are in the lower six bits of the tag."""
    tag = data[position]
    position += 1
    for _ in range(3):
        end = position + (tag & 3) + 1
        if end > len(data):
            raise IndexError
        values.append(int.from_bytes(data[position:end], "little", signed=True))
        position, tag = end, tag >> 2
    return position


#: Three signed numbers by the 12 bits that encode them (4 bits each), and by 14 bits (5, 5 and 4 bits).
_FOURS: Final = tuple(tuple(extended(bits >> shift, 4) for shift in (8, 4, 0)) for bits in range(1 << 12))
_FIVES: Final = tuple(
    (extended(bits >> 9, 5), extended(bits >> 4, 5), extended(bits, 4)) for bits in range(1 << 14)
)


def _read_tag2_3s32(data: bytes, position: int, _count: int, values: list[int]) -> int:
    """Read three numbers of 2, 4, 6 bits, or of one to four bytes each."""
    first = data[position]
    kind = first >> 6
    if kind == 0:
        values += SMALL_TRIPLES[first]
        return position + 1
    if kind == 1:
        values += _FOURS[(first & 15) << 8 | data[position + 1]]
        return position + 2
    if kind == 2:
        values += (extended(first, 6), extended(data[position + 1], 6), extended(data[position + 2], 6))
        return position + 3
    return _read_sized(data, position, values)


def _read_tag2_3svariable(data: bytes, position: int, _count: int, values: list[int]) -> int:
    """Read three numbers of 2, of 5, 5 and 4, of 8, 7 and 7 bits, or of one to four bytes each."""
    first = data[position]
    kind = first >> 6
    if kind == 0:
        values += SMALL_TRIPLES[first]
        return position + 1
    if kind == 1:
        values += _FIVES[(first & 63) << 8 | data[position + 1]]
        return position + 2
    if kind == 2:
        bits = first << 16 | data[position + 1] << 8 | data[position + 2]
        values += (extended(bits >> 14, 8), extended(bits >> 7, 7), extended(bits, 7))
        return position + 3
    return _read_sized(data, position, values)


def _packed_layout(tag: int) -> tuple[int, tuple[tuple[int, int, int], ...]]:
    """Return the bytes behind a tag of four sizes, and the shift, mask and sign bit of each number."""
    sizes = [(0, 4, 8, 16)[tag >> shift & 3] for shift in (0, 2, 4, 6)]
    size, place = (sum(sizes) + 7) // 8, 0
    fields = []
    for bits in sizes:
        place += bits
        fields.append((8 * size - place, (1 << bits) - 1, 1 << bits >> 1))
    return size, tuple(fields)


_PACKED: Final = tuple(map(_packed_layout, range(256)))


def _read_tag8_4s16(data: bytes, position: int, _count: int, values: list[int]) -> int:
    """Read four numbers of 0, 4, 8 or 16 bits, one behind the other without gaps, high bits first."""
    size, fields = _PACKED[data[position]]
    position += 1
    end = position + size
    if end > len(data):
        raise IndexError
    bits = int.from_bytes(data[position:end], "big")
    values += [((bits >> shift & mask) ^ sign) - sign for shift, mask, sign in fields]
    return end


def read_tag8_4s16_v1(data: bytes, position: int, _count: int, values: list[int]) -> int:
    """Read four numbers of 0, 4, 8 or 16 bits as data version 1 has them: 4-bit numbers are in pairs."""
    tag = data[position]
    position += 1
    found: list[int] = []
    while len(found) < 4:
        kind, tag = tag & 3, tag >> 2
        if kind == 0:
            found.append(0)
        elif kind == 1:
            found += (extended(data[position], 4), extended(data[position] >> 4, 4))
            position, tag = position + 1, tag >> 2
        elif kind == 2:
            found.append(extended(data[position], 8))
            position += 1
        else:
            found.append(extended(data[position] | data[position + 1] << 8, 16))
            position += 2
    values += found[:4]
    return position


#: Readers by the number of their encoding.
READERS: Final[Mapping[int, Reader]] = MappingProxyType(
    {
        SIGNED_VB: _read_signed,
        UNSIGNED_VB: _read_unsigned,
        NEGATIVE_14_BIT: _read_negative,
        TAG8_8SVB: _read_tag8_8svb,
        TAG2_3S32: _read_tag2_3s32,
        TAG8_4S16: _read_tag8_4s16,
        NOTHING: _read_nothing,
        TAG2_3SVARIABLE: _read_tag2_3svariable,
    }
)
#: Number of fields in a group, by encoding; other encodings have groups of any size.
GROUPS: Final[Mapping[int, int]] = MappingProxyType({TAG2_3S32: 3, TAG8_4S16: 4, TAG2_3SVARIABLE: 3})
