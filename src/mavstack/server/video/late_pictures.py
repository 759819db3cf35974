"""Pictures that wait for the disk, bounded by bytes.

A compressed picture needs the ones before it. When a picture would exceed the bound, all waiting pictures are
dropped, and the next ones until one that needs no other.
"""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Final

from mavstack.errors import MissingExtraError

try:
    import av
except ImportError as missing:
    raise MissingExtraError("recording of video", "video") from missing

if TYPE_CHECKING:
    Picture = av.Packet[av.VideoStream] | av.VideoFrame

#: Maximum bytes that wait: seconds of a compressed camera, a dozen decoded pictures.
#: One picture may have more.
MAX_WAITING: Final = 32 << 20


class LatePictures:
    """The queue between a camera and its file."""

    def __init__(self) -> None:
        self._waiting: deque[Picture] = deque()
        self._bytes = 0
        self._changed = asyncio.Event()
        self._needs_key = False
        self._ended = False
        #: The number of pictures that were dropped.
        self.dropped = 0

    def __len__(self) -> int:
        """Return the number of pictures that wait."""
        return len(self._waiting)

    def put(self, picture: Picture) -> None:
        """Add a picture; the waiting ones are dropped if they would be too many bytes."""
        size = _size_of(picture)
        if self._waiting and self._bytes + size > MAX_WAITING:
            self.dropped += len(self._waiting)
            self._waiting.clear()
            self._bytes, self._needs_key = 0, True
        if self._needs_key and isinstance(picture, av.Packet) and not picture.is_keyframe:
            self.dropped += 1
            return
        self._needs_key = False
        self._bytes += size
        self._waiting.append(picture)
        self._changed.set()

    def end(self) -> None:
        """Let `get` return None when no picture waits any more."""
        self._ended = True
        self._changed.set()

    async def get(self) -> Picture | None:
        """Wait for the next picture; None: the camera has ended its stream."""
        while not self._waiting:
            if self._ended:
                return None
            self._changed.clear()
            await self._changed.wait()
        picture = self._waiting.popleft()
        self._bytes -= _size_of(picture)
        return picture


def _size_of(picture: Picture) -> int:
    if isinstance(picture, av.Packet):
        return picture.size
    return sum(plane.buffer_size for plane in picture.planes)
