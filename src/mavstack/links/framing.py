"""Length-prefixed frames over a stream: 4 bytes of length, big-endian, then that many bytes of packets.

Programs that exchange whole datagrams over a Unix stream socket use them. A frame keeps the boundaries of
what the sender wrote, so it is one chunk of the link. A frame of length 0 carries nothing and is skipped.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.errors import LinkError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.links.channel import Data

PREFIX: Final = 4
#: Maximum size of a frame. A plain MAVLink stream, which begins with 0xFD or 0xFE, appears as a longer frame.
MAX_FRAME: Final = 1 << 20


def frame(data: Data) -> bytes:
    """Return data as one frame."""
    return len(data).to_bytes(PREFIX, "big") + data


class FrameReader:
    """Splits a stream, in chunks of any size, into the contents of its frames."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> Iterator[bytes]:
        """Add a chunk; yield the contents of the complete frames.

        Raises:
            LinkError: A frame is longer than `MAX_FRAME`.
        """
        data, position = self._rest + data, 0
        while (start := position + PREFIX) <= len(data):
            length = int.from_bytes(data[position:start], "big")
            if length > MAX_FRAME:
                raise LinkError(f"a frame of {length} bytes: the peer does not use framing=length")
            if start + length > len(data):
                break
            position = start + length
            if length:
                yield data[start:position]
        self._rest = data[position:]
