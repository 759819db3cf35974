"""Frames in a stream of bytes: between delimiters, or with a marker, a length and a checksum.

Each class is fed with bytes as they come, and returns the frames that they complete. Which frames it finds
does not depend on where the bytes are cut. The pages of the station do the same
(`web/src/lib/frames/framing.ts`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Protocol

if TYPE_CHECKING:
    from mavstack.server.rows.frame_decoder import Checksum, Framing

#: Maximum size in bytes of a frame in a stream, and of a datagram.
MAX_FRAME: Final = 4096
MAX_DATAGRAM: Final = 65_535
#: Limits of searches for a frame: bytes that may be checked without a result, and bytes that each byte of the
#: stream adds to this credit.
_CREDIT: Final = 4 * MAX_FRAME
_EARNED: Final = 4


class Framer(Protocol):
    """Finds frames; `refused` counts those that were too long or wrong."""

    refused: int

    def feed(self, data: bytes) -> list[bytes]:
        """Return the frames that bytes complete."""


class DatagramFramer:
    """Each chunk is a frame."""

    def __init__(self, checksum: Checksum | None) -> None:
        self.refused = 0
        self._checksum = checksum

    def feed(self, data: bytes) -> list[bytes]:
        """Return the chunk."""
        if len(data) <= MAX_DATAGRAM and (self._checksum is None or self._checksum.fits(data)):
            return [data]
        self.refused += 1
        return []


class DelimiterFramer:
    """Frames end with a delimiter, which is not part of them; empty ones are ignored.

    Args:
        delimiter: The delimiter.
        checksum: The checksum of the frames.
        is_cobs: The frames are encoded by COBS.
    """

    def __init__(self, delimiter: bytes, checksum: Checksum | None, *, is_cobs: bool = False) -> None:
        self.refused = 0
        self._delimiter, self._checksum, self._is_cobs = delimiter, checksum, is_cobs
        self._pending = b""
        self._is_too_long = False

    def feed(self, data: bytes) -> list[bytes]:
        """Return the frames that bytes complete."""
        *complete, self._pending = (self._pending + data).split(self._delimiter)
        frames = [frame for each in complete if (frame := self._end(each)) is not None]
        if len(self._pending) > MAX_FRAME + len(self._delimiter):
            self._pending = self._pending[1 - len(self._delimiter) :] if len(self._delimiter) > 1 else b""
            self._is_too_long = True
        return frames

    def _end(self, frame: bytes) -> bytes | None:
        is_too_long, self._is_too_long = self._is_too_long or len(frame) > MAX_FRAME, False
        if not frame and not is_too_long:
            return None
        decoded = None if is_too_long else decode_cobs(frame) if self._is_cobs else frame
        if decoded is None or not (self._checksum is None or self._checksum.fits(decoded)):
            self.refused += 1
            return None
        return decoded


class SizedFramer:
    """Frames have a fixed size or a field with it, usually after a marker.

    After a wrong checksum the search continues at the next byte, since the marker may have been a value. A
    stream that is made of such markers would cost a check for each byte: then whole frames are left out.
    """

    def __init__(self, framing: Framing, checksum: Checksum | None) -> None:
        self.refused = 0
        self._framing, self._checksum = framing, checksum
        self._pending = b""
        #: The index of the first byte of `_pending` that was not handled yet.
        self._at = 0
        self._credit = _CREDIT

    def feed(self, data: bytes) -> list[bytes]:
        """Return the frames that bytes complete."""
        self._pending += data
        frames: list[bytes] = []
        while self._find_marker() and (size := self._size()) is not None:
            if not max(self._framing.header, 1) <= size <= MAX_FRAME:
                self._skip(1)
                continue
            frame = self._pending[self._at : self._at + size]
            if len(frame) < size:
                break
            if self._checksum is None or self._checksum.fits(frame):
                frames.append(frame)
                self._advance(size)
            else:
                self._credit -= size
                self._skip(1 if self._credit >= 0 else size)
        self._pending, self._at = self._pending[self._at :], 0
        return frames

    def _find_marker(self) -> bool:
        """Advance to the next marker; return whether there is one."""
        marker, end = self._framing.marker, len(self._pending)
        found = self._pending.find(marker, self._at)
        if found < 0:  # keep the last bytes: they may be the beginning of a marker
            self._advance(max(end - len(marker) + 1 - self._at, 0))
            return False
        self._advance(found - self._at)
        return self._at < end

    def _size(self) -> int | None:
        """Return the size of the frame that begins here; None: its length has not come yet."""
        framing = self._framing
        if framing.length is None:
            return framing.size
        header = self._pending[self._at : self._at + framing.header]
        return int(framing.length.read(header)) + framing.add if len(header) == framing.header else None

    def _skip(self, count: int) -> None:
        self.refused += 1
        self._advance(count)

    def _advance(self, count: int) -> None:
        self._at += count
        self._credit = min(_CREDIT, self._credit + _EARNED * count)


def make_framer(framing: Framing, checksum: Checksum | None) -> Framer:
    """Return the framer of a stream."""
    if framing.kind == "datagram":
        return DatagramFramer(checksum)
    if framing.kind in {"delimiter", "cobs"}:
        return DelimiterFramer(framing.marker, checksum, is_cobs=framing.kind == "cobs")
    return SizedFramer(framing, checksum)


def decode_cobs(data: bytes) -> bytes | None:
    """Return the bytes that COBS (consistent overhead byte stuffing) encodes; None if they are malformed."""
    found = bytearray()
    at = 0
    while at < len(data):
        code = data[at]
        block = data[at + 1 : at + code]
        if code == 0 or len(block) != code - 1 or 0 in block:
            return None
        found += block
        at += code
        if code < 0xFF and at < len(data):  # no zero byte follows a block of maximum length
            found.append(0)
    return bytes(found)
