"""The framing of tlogs: before each packet 8 bytes of time, in big-endian microseconds since 1970.

To pace a replay only the times and lengths of the packets are needed, so this scanner reads the first three
bytes of each packet: the magic (0xFE in version 1, 0xFD in version 2), the payload length, and in version 2
the flag of a signature. Junk between packets is kept, with the time of the previous packet: the parser of the
link counts it as it would on a live link.
"""

from __future__ import annotations

import re
from typing import Final, TypeAlias

TimedPacket: TypeAlias = tuple[float, bytes]

_TIMESTAMP: Final = 8
_V1: Final = 0xFE
_LENGTH_PREFIX: Final = 3  # first bytes of a packet, which determine its length
_OVERHEAD_V1: Final = 8  # header and checksum
_OVERHEAD_V2: Final = 12
_SIGNATURE: Final = 13
_MAGICS: Final = (b"\xfd", b"\xfe")
_ADJACENT_PACKETS: Final = 4
_ENTRY = re.compile(rb"\x00[\x00-\x0e][\x00-\xff]{6}[\xfd\xfe]")  # time before 2100, first byte of a packet


class TlogScanner:
    """Splits a tlog, in chunks of any size, into packets with their times."""

    def __init__(self) -> None:
        self._rest = b""
        self._time = 0.0

    def feed(self, data: bytes) -> list[TimedPacket]:
        """Add a chunk; return the complete packets with their times in Unix seconds."""
        data = self._rest + data
        found: list[TimedPacket] = []
        position, end = 0, len(data)
        while position + _TIMESTAMP + _LENGTH_PREFIX <= end:
            if not _is_entry(data, position):
                position = self._skip_junk(data, position, found)
                continue
            start = position + _TIMESTAMP
            following = start + _packet_length(data, start)
            if following > end:
                break
            self._time = int.from_bytes(data[position:start], "big") * 1e-6
            found.append((self._time, data[start:following]))
            position = following
        self._rest = data[position:]
        return found

    def finish(self) -> list[TimedPacket]:
        """Return the rest of a log that ends within a packet."""
        rest, self._rest = self._rest, b""
        return [(self._time, rest)] if rest else []

    def _skip_junk(self, data: bytes, position: int, found: list[TimedPacket]) -> int:
        """Return the start of the next entry, or the last position at which an incomplete one may start."""
        match = _ENTRY.search(data, position + 1)
        following = match.start() if match else max(position + 1, len(data) - _TIMESTAMP)
        found.append((self._time, data[position:following]))
        return following


def looks_like_tlog(data: bytes) -> bool:
    """Return whether the beginning of a file contains two adjacent entries of a tlog, not only packets."""
    if _begins_with_packets(data):
        return False
    for match in _ENTRY.finditer(data):
        start = match.end() - 1
        if start + _LENGTH_PREFIX > len(data):
            return False
        following = start + _packet_length(data, start)
        if following == len(data) or _is_entry(data, following):
            return True
    return False


def _begins_with_packets(data: bytes) -> bool:
    """Return whether packets without times follow each other: zeros in their payloads may look like times."""
    position = 0
    for _ in range(_ADJACENT_PACKETS):
        if data[position : position + 1] not in _MAGICS or position + _LENGTH_PREFIX > len(data):
            return False
        position += _packet_length(data, position)
        if position == len(data):
            return True
    return position < len(data)


def _is_entry(data: bytes, position: int) -> bool:
    return _ENTRY.match(data, position) is not None


def _packet_length(data: bytes, start: int) -> int:
    if data[start] == _V1:
        return _OVERHEAD_V1 + data[start + 1]
    return _OVERHEAD_V2 + data[start + 1] + (_SIGNATURE if data[start + 2] & 1 else 0)
