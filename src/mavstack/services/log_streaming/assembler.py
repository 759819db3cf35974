"""The log of a stream of blocks: complete messages only, and a dropout message where blocks are missing."""

from __future__ import annotations

from typing import NamedTuple

from mavstack.services.log_streaming.framing import (
    HALF,
    HEADER_SIZE,
    MAGIC,
    SEQUENCES,
    dropout,
    whole_messages,
)


class Assembled(NamedTuple):
    """The result of one block.

    Attributes:
        data: Bytes to append to the log: the header or complete messages; may be empty.
        lost: Blocks that are missing before this one.
    """

    data: bytes = b""
    lost: int = 0


class LogAssembler:
    """Puts blocks together to a log that is valid at any time.

    It begins with the block that has the file header; blocks before it belong to an earlier stream.
    """

    def __init__(self) -> None:
        #: True once the header was received.
        self.has_started = False
        #: The number of bytes of the log so far.
        self.size = 0
        self._expected = 0
        self._rest = bytearray()
        self._is_lost = False
        self._last_block: float | None = None

    def is_new(self, sequence: int) -> bool:
        """Return whether a block with this number was not received before."""
        return not self.has_started or (sequence - self._expected) % SEQUENCES < HALF

    def add(self, sequence: int, data: bytes, first: int, now: float) -> Assembled:
        """Add a block.

        Args:
            sequence: The number of the block.
            data: Its bytes.
            first: Where the first message starts in it; 255: nowhere.
            now: The time, in seconds.
        """
        if not self.has_started:
            return self._begin(sequence, data, now)
        if not self.is_new(sequence):
            return Assembled()
        lost = (sequence - self._expected) % SEQUENCES
        self._expected = (sequence + 1) % SEQUENCES
        gap = b""
        if lost:
            if not self._is_lost:
                gap = dropout(now - (now if self._last_block is None else self._last_block))
            self._is_lost = True
            self._rest.clear()
        self._last_block = now
        if self._is_lost and first >= len(data):
            return self._counted(gap, lost)
        if self._is_lost:
            data, self._is_lost = data[first:], False
        self._rest += data
        return self._counted(gap + self._complete(), lost)

    def _begin(self, sequence: int, data: bytes, now: float) -> Assembled:
        if not data.startswith(MAGIC) or len(data) < HEADER_SIZE:
            return Assembled()
        self.has_started, self._last_block = True, now
        self._expected = (sequence + 1) % SEQUENCES
        self._rest += data[HEADER_SIZE:]
        return self._counted(data[:HEADER_SIZE] + self._complete(), 0)

    def _complete(self) -> bytes:
        end = whole_messages(self._rest)
        data = bytes(self._rest[:end])
        del self._rest[:end]
        return data

    def _counted(self, data: bytes, lost: int) -> Assembled:
        self.size += len(data)
        return Assembled(data, lost)
