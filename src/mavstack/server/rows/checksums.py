"""Checksums of frames: sums, and cyclic redundancy checks by the names that their catalogues use.

The pages of the station compute the same (`web/src/lib/frames/checksums.ts`).
"""

from __future__ import annotations

from functools import cache, reduce
from operator import xor
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


class Crc(NamedTuple):
    """The parameters of a cyclic redundancy check.

    Attributes:
        width: The number of bits.
        polynomial: The polynomial without its highest bit.
        initial: The value before the first byte.
        reflected: The lowest bit of each byte comes first.
        final: The bits that are inverted in the end.
    """

    width: int
    polynomial: int
    initial: int
    reflected: bool
    final: int

    def of(self, data: bytes) -> int:
        """Return the check of bytes."""
        table, value = _table(self), self.initial
        if self.reflected:
            for byte in data:
                value = table[(value ^ byte) & 0xFF] ^ (value >> 8)
        else:
            shift, mask = self.width - 8, (1 << self.width) - 1
            for byte in data:
                value = table[((value >> shift) ^ byte) & 0xFF] ^ ((value << 8) & mask)
        return value ^ self.final


_CRCS: Final[Mapping[str, Crc]] = MappingProxyType(
    {
        "crc8": Crc(8, 0x07, 0, False, 0),
        "crc8-dvb-s2": Crc(8, 0xD5, 0, False, 0),
        "crc8-maxim": Crc(8, 0x31, 0, True, 0),
        "crc16-ccitt": Crc(16, 0x1021, 0xFFFF, False, 0),
        "crc16-xmodem": Crc(16, 0x1021, 0, False, 0),
        "crc16-x25": Crc(16, 0x1021, 0xFFFF, True, 0xFFFF),
        "crc16-mcrf4xx": Crc(16, 0x1021, 0xFFFF, True, 0),
        "crc16-modbus": Crc(16, 0x8005, 0xFFFF, True, 0),
        "crc16-arc": Crc(16, 0x8005, 0, True, 0),
        "crc32": Crc(32, 0x04C11DB7, 0xFFFFFFFF, True, 0xFFFFFFFF),
    }
)


def _fletcher8(data: bytes) -> int:
    """Return the two sums of u-blox receivers; the first one is the low byte."""
    first = second = 0
    for byte in data:
        first = (first + byte) & 0xFF
        second = (second + first) & 0xFF
    return first | second << 8


_SUMS: Final[Mapping[str, tuple[int, Callable[[bytes], int]]]] = MappingProxyType(
    {
        "sum8": (1, lambda data: sum(data) & 0xFF),
        "sum16": (2, lambda data: sum(data) & 0xFFFF),
        "xor8": (1, lambda data: reduce(xor, data, 0)),
        "fletcher8": (2, _fletcher8),
    }
)
#: Length in bytes, and function, of each kind of checksum.
CHECKSUMS: Final[Mapping[str, tuple[int, Callable[[bytes], int]]]] = MappingProxyType(
    {**_SUMS, **{name: (crc.width // 8, crc.of) for name, crc in _CRCS.items()}}
)


@cache
def _table(crc: Crc) -> tuple[int, ...]:
    return tuple(_entry(crc, byte) for byte in range(256))


def _entry(crc: Crc, byte: int) -> int:
    if crc.reflected:
        polynomial, value = int(f"{crc.polynomial:0{crc.width}b}"[::-1], 2), byte
        for _ in range(8):
            value = value >> 1 ^ (polynomial if value & 1 else 0)
        return value
    value, top, mask = byte << crc.width - 8, 1 << crc.width - 1, (1 << crc.width) - 1
    for _ in range(8):
        value = (value << 1 ^ (crc.polynomial if value & top else 0)) & mask
    return value
