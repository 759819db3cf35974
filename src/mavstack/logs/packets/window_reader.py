"""Reading a log of packets piece by piece into one buffer, so that memory does not grow with the file."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack._core import Index, WindowIndexer
    from mavstack.logs.log_bytes import LogBytes


def index_windows(data: LogBytes, indexer: WindowIndexer, size: int) -> Iterator[tuple[Index, int]]:
    """Index a file piece by piece.

    Args:
        data: The bytes of the file.
        indexer: The indexer, which carries the state from one piece to the next.
        size: Bytes of the file in a piece.

    Yields:
        The index of each piece, which is valid until the next one is asked for, and the bytes read so far.

    Raises:
        LogError: The file was truncated, or cannot be read.
    """
    buffer, left, position = bytearray(), 0, 0
    while True:
        count = min(max(size, 1), data.size - position)
        if left + count > len(buffer):
            # The remaining bytes are fewer than a packet, unless the windows are tiny.
            buffer = buffer[:left] + bytearray(count + left)
        view = memoryview(buffer)[: left + count]
        data.read_into(position, view[left:])
        position += count
        last = position >= data.size
        index, done = indexer.next(view.toreadonly(), last=last)
        yield index, position
        if last:
            return
        left += count - done
        buffer[:left] = bytes(view[done : done + left])
