"""The part of a file that was received so far, in any order, and the ranges that are missing.

It outlives the session in which it was received: after an interruption the file is opened again and only the
missing ranges are requested.
"""

from __future__ import annotations

from mavstack.services.ftp.missing_ranges import MissingRanges


class PartialFile:
    """The received part of a range of a file; `end` may move to a lower offset.

    Args:
        start: The offset of the first byte.
        end: The offset behind the last byte, as announced.
    """

    def __init__(self, start: int, end: int) -> None:
        self.start, self.end = start, end
        self.missing = MissingRanges(start, end)
        self._pieces: dict[int, bytes] = {}

    @property
    def total(self) -> int:
        """The size of the range in bytes."""
        return self.end - self.start

    @property
    def received(self) -> int:
        """The number of bytes received."""
        return self.total - self.missing.total

    def store(self, offset: int, data: bytes) -> int:
        """Store the missing part of a piece; returns its number of bytes."""
        new = 0
        for low, high in self.missing.remove(offset, offset + len(data)):
            self._pieces[low] = data[low - offset : high - offset]
            new += high - low
        return new

    def end_at(self, offset: int) -> bool:
        """Let the file end at an offset; returns False if data beyond it was received."""
        if offset >= self.end:
            return True
        if any(low + len(piece) > offset for low, piece in self._pieces.items()):
            return False
        self.missing.remove(max(offset, self.start), self.end)
        self.end = max(offset, self.start)
        return True

    def content(self) -> bytes:
        """Return the received bytes."""
        return b"".join(self._pieces[low] for low in sorted(self._pieces))
