"""The received chunks of a log, and which are missing.

A log consists of chunks of 90 bytes; all are full except the last, which has 0 to 89 bytes and so marks the
end. The listed size may be wrong: data beyond it counts, and a short chunk before it reports an earlier end.
Such a report may also be the tail of another client's request, or a failed read, so it is accepted only after
several of them, and only if the listed size was nearly right. Chunks received twice must be equal.
"""

from __future__ import annotations

from mavstack.services.log.entry import CHUNK

MIN_END_REPORTS = 3
#: The number of bytes by which a listed size may be too large: a few blocks of flash memory.
MAX_SIZE_ERROR = 1 << 16
_MAX_PARTIAL = 64
FIRST_CHUNKS = 12


class Collector:
    """The chunks of one log; `size` is the size of the log as known so far."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.received = 0
        self.end_known = False
        self.contradicted = False
        self.earliest: list[int] = []  # the first full chunks, in order of arrival
        self._data = bytearray()
        self._full = bytearray()  # 1 for each received chunk
        self._partial: dict[int, bytes] = {}
        self._end_reports: dict[int, int] = {}
        self._first_missing = 0

    @property
    def last_chunk(self) -> int:
        """The number of the chunk in which the log ends."""
        return self.size // CHUNK

    @property
    def complete(self) -> bool:
        """True if the whole log and its end were received."""
        return self.end_known and self.first_missing() >= self.last_chunk

    @property
    def lacks_only_the_end(self) -> bool:
        """True if the listed size was received, and only the empty last chunk is missing."""
        return self.size % CHUNK == 0 and not self.end_known and self.first_missing() == self.last_chunk

    def data(self) -> bytes:
        """Return the content of the log."""
        start = self.last_chunk * CHUNK
        return bytes(self._data[:start]) + self._partial.get(self.last_chunk, b"")[: self.size - start]

    def first_missing(self) -> int:
        """Return the first missing chunk; the last one counts as missing until the end is known."""
        self._first_missing = self._next_missing(self._first_missing)
        return self._first_missing

    def missing_range(self, cursor: int, max_chunks: int, merge: int) -> tuple[int, int]:
        """Return the next chunks to request, from `cursor` on; received runs up to `merge` are included."""
        limit = self.last_chunk + (not self.end_known)
        start = self._next_missing(cursor)
        if start >= limit:
            start = self.first_missing()
        limit = max(min(start + max_chunks, limit), start + 1)
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

    def add(self, chunk: int, content: bytes, *, requested: bool) -> bool:
        """Add a chunk; returns True if it is new. `requested`: the local request covers the whole chunk."""
        known = self._known(chunk)
        if known is not None and not _agree(known, content):
            self.contradicted = True
            return False
        if len(content) == CHUNK:
            return known != content and self._add_full(chunk, content)
        return self._add_partial(chunk, content, known, requested=requested)

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
        if len(self.earliest) < FIRST_CHUNKS:
            self.earliest.append(chunk)
        if (chunk + 1) * CHUNK > self.size:
            self.size, self.end_known = (chunk + 1) * CHUNK, False
        return True

    def _add_partial(self, chunk: int, content: bytes, known: bytes | None, *, requested: bool) -> bool:
        end = chunk * CHUNK + len(content)
        if known is not None and len(known) > len(content):
            return False
        if len(self._partial) < _MAX_PARTIAL or chunk in self._partial:
            self._partial[chunk] = content
        if end < self.size:
            return requested and self._report_end(end)
        if not requested and end > self.size:
            return False
        is_new = not self.end_known or end > self.size
        self.size, self.end_known = end, True
        self._partial[chunk] = content
        return is_new

    def _report_end(self, end: int) -> bool:
        self._end_reports[end] = self._end_reports.get(end, 0) + 1
        if len(self._end_reports) > _MAX_PARTIAL:
            del self._end_reports[next(iter(self._end_reports))]
        if self._end_reports.get(end, 0) < MIN_END_REPORTS:
            return False
        if self.size - end > MAX_SIZE_ERROR or end < len(self._full) * CHUNK:
            self.contradicted = True
            return False
        self.size, self.end_known = end, True
        return True


def _agree(one: bytes, other: bytes) -> bool:
    shorter = min(len(one), len(other))
    return one[:shorter] == other[:shorter]
