"""The parts of a log that have arrived, and which are missing.

A log is seen as chunks of 90 bytes; all are full but the last, which has 0 to 89 and so says where the log
ends. The listed size may be wrong: what comes beyond it counts, and a short chunk before it is a claim that
the log ends there. Such a claim may also be the tail of what another client asked for, or a read that
failed, so it is believed only if it was made several times and the size was nearly right. Whatever comes
twice must say the same.
"""

from __future__ import annotations

from mavstack.services.log.entry import CHUNK

CLAIMS = 3
#: By how much a listed size may be too large, in bytes: a few blocks of flash memory.
TOLERANCE = 1 << 16
_MOST_PARTIAL = 64
EARLIEST = 12


class Collector:
    """Takes in chunks; `size` is what is known of the log's size."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.received = 0
        self.end_known = False
        self.contradicted = False
        self.earliest: list[int] = []  # the first full chunks, as they came
        self._data = bytearray()
        self._full = bytearray()  # 1 for each chunk that is there
        self._partial: dict[int, bytes] = {}
        self._claims: dict[int, int] = {}
        self._first_missing = 0

    @property
    def last_chunk(self) -> int:
        """The number of the chunk in which the log ends."""
        return self.size // CHUNK

    @property
    def complete(self) -> bool:
        """Whether all is there, the end included."""
        return self.end_known and self.first_missing() >= self.last_chunk

    @property
    def lacks_only_the_end(self) -> bool:
        """Whether all of the listed size is there, and only that nothing follows was not said."""
        return self.size % CHUNK == 0 and not self.end_known and self.first_missing() == self.last_chunk

    def data(self) -> bytes:
        """The log."""
        start = self.last_chunk * CHUNK
        return bytes(self._data[:start]) + self._partial.get(self.last_chunk, b"")[: self.size - start]

    def first_missing(self) -> int:
        """The first chunk that is not there; the last one counts as missing until the end is known."""
        self._first_missing = self._next_missing(self._first_missing)
        return self._first_missing

    def missing_range(self, cursor: int, most: int, merge: int) -> tuple[int, int]:
        """The next chunks to ask for from `cursor` on; what is there ends it if longer than `merge`."""
        limit = self.last_chunk + (not self.end_known)
        start = self._next_missing(cursor)
        if start >= limit:
            start = self.first_missing()
        limit = max(min(start + most, limit), start + 1)
        there = self._full.find(1, start, limit)
        while there >= 0:
            following = self._next_missing(there)
            if following - there > merge or following >= limit:
                return start, there
            there = self._full.find(1, following, limit)
        return start, limit

    def _next_missing(self, chunk: int) -> int:
        found = self._full.find(0, chunk)
        return found if found >= 0 else max(chunk, len(self._full))

    def add(self, chunk: int, content: bytes, *, asked: bool) -> bool:
        """Take in a chunk, True if it is new; `asked` if a request of ours covers the whole chunk."""
        known = self._known(chunk)
        if known is not None and not _agree(known, content):
            self.contradicted = True
            return False
        if len(content) == CHUNK:
            return known != content and self._add_full(chunk, content)
        return self._add_partial(chunk, content, known, asked=asked)

    def _known(self, chunk: int) -> bytes | None:
        if chunk < len(self._full) and self._full[chunk]:
            return bytes(self._data[chunk * CHUNK : (chunk + 1) * CHUNK])
        return self._partial.get(chunk)

    def _add_full(self, chunk: int, content: bytes) -> bool:
        if chunk >= len(self._full):
            self._full.extend(bytes(chunk + 1 - len(self._full)))
            self._data.extend(bytes(len(self._full) * CHUNK - len(self._data)))
        self._data[chunk * CHUNK : (chunk + 1) * CHUNK] = content
        self._full[chunk] = 1
        self._partial.pop(chunk, None)
        self.received += CHUNK
        if len(self.earliest) < EARLIEST:
            self.earliest.append(chunk)
        if (chunk + 1) * CHUNK > self.size:
            self.size, self.end_known = (chunk + 1) * CHUNK, False
        return True

    def _add_partial(self, chunk: int, content: bytes, known: bytes | None, *, asked: bool) -> bool:
        end = chunk * CHUNK + len(content)
        if known is not None and len(known) > len(content):
            return False
        if len(self._partial) < _MOST_PARTIAL or chunk in self._partial:
            self._partial[chunk] = content
        if end < self.size:
            return asked and self._claim(end)
        if not asked and end > self.size:
            return False
        news = not self.end_known or end > self.size
        self.size, self.end_known = end, True
        self._partial[chunk] = content
        return news

    def _claim(self, end: int) -> bool:
        self._claims[end] = self._claims.get(end, 0) + 1
        if len(self._claims) > _MOST_PARTIAL:
            del self._claims[next(iter(self._claims))]
        if self._claims.get(end, 0) < CLAIMS:
            return False
        if self.size - end > TOLERANCE or end < len(self._full) * CHUNK:
            self.contradicted = True
            return False
        self.size, self.end_known = end, True
        return True


def _agree(one: bytes, other: bytes) -> bool:
    shorter = min(len(one), len(other))
    return one[:shorter] == other[:shorter]
