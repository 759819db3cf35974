"""Types of the units of H.264 in a packet (H.264, annex B and section 7.3.1)."""

from __future__ import annotations

from typing import Final

_START: Final = b"\x00\x00\x01"
#: Types of units: slices of pictures (5: of one that needs no other), and the two parameter sets.
SLICES: Final = frozenset({1, 2, 5})
PARAMETER_SETS: Final = frozenset({7, 8})
#: The largest type of a unit in a stream; the ones above belong to transports.
_MAX_TYPE: Final = 21


def unit_types(data: bytes) -> frozenset[int]:
    """Return the types of the units of a packet.

    Args:
        data: The packet, whose units follow start codes.

    Returns:
        The types; empty: the packet does not begin with a start code, or contains a unit that cannot exist.
    """
    start = data.find(_START)
    if start < 0 or data[:start].strip(b"\0"):
        return frozenset()
    found = set()
    while start >= 0:
        head = data[start + 3] if start + 3 < len(data) else 0
        # The first bit is zero in every unit.
        if not 0 < (head & 0x9F) <= _MAX_TYPE:
            return frozenset()
        found.add(head & 0x1F)
        start = data.find(_START, start + 3)
    return frozenset(found)
