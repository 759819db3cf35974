"""The framing of a telemetry log: before each packet 8 bytes, big-endian microseconds since 1970.

To pace a replay only the times and the lengths of the packets matter, so this scan looks at nothing but a
packet's first three bytes: the magic (0xFE version 1, 0xFD version 2), the payload's length, and of version
2 the flag that a signature follows. Junk between packets is kept, at the time of the packet before it: the
parser behind the link counts it as it would have on the live link.
"""

from __future__ import annotations

import re
from typing import Final, TypeAlias

Timed: TypeAlias = tuple[float, bytes]

_STAMP: Final = 8
_V1: Final = 0xFE
_HEADER: Final = 3  # bytes of a packet that tell its length
_OVERHEAD_V1: Final = 8  # header and checksum
_OVERHEAD_V2: Final = 12
_SIGNATURE: Final = 13
_ENTRY = re.compile(rb"\x00[\x00-\x0e][\x00-\xff]{6}[\xfd\xfe]")  # a time before 2100, then a magic


class TlogScanner:
    """Cuts a telemetry log, fed in pieces of any size, into timed packets."""

    def __init__(self) -> None:
        self._rest = b""
        self._time = 0.0

    def feed(self, data: bytes) -> list[Timed]:
        """The packets that are whole so far; their times are unix seconds."""
        data = self._rest + data
        found: list[Timed] = []
        position, end = 0, len(data)
        while position + _STAMP + _HEADER <= end:
            if not _is_entry(data, position):
                position = self._skip_junk(data, position, found)
                continue
            start = position + _STAMP
            following = start + _packet_length(data, start)
            if following > end:
                break
            self._time = int.from_bytes(data[position:start], "big") * 1e-6
            found.append((self._time, data[start:following]))
            position = following
        self._rest = data[position:]
        return found

    def finish(self) -> list[Timed]:
        """What is left of a log that ends within a packet."""
        rest, self._rest = self._rest, b""
        return [(self._time, rest)] if rest else []

    def _skip_junk(self, data: bytes, position: int, found: list[Timed]) -> int:
        """Find the next entry, or the last place where a cut one may begin."""
        match = _ENTRY.search(data, position + 1)
        following = match.start() if match else max(position + 1, len(data) - _STAMP)
        found.append((self._time, data[position:following]))
        return following


def looks_like_tlog(data: bytes) -> bool:
    """Whether two entries follow each other somewhere in the beginning of a file."""
    for match in _ENTRY.finditer(data):
        start = match.end() - 1
        if start + _HEADER > len(data):
            return False
        following = start + _packet_length(data, start)
        if following == len(data) or _is_entry(data, following):
            return True
    return False


def _is_entry(data: bytes, position: int) -> bool:
    return _ENTRY.match(data, position) is not None


def _packet_length(data: bytes, start: int) -> int:
    if data[start] == _V1:
        return _OVERHEAD_V1 + data[start + 1]
    return _OVERHEAD_V2 + data[start + 1] + (_SIGNATURE if data[start + 2] & 1 else 0)
