"""A recorded stream of packets: a tlog, raw bytes, or standard input, read piece by piece.

The memory is bounded by one piece of the file and the last packet of each message, whatever the size of the
file. An index of a mapped file would be faster, but grows with the file.
"""

from __future__ import annotations

import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final

from mavstack._core import looks_timestamped
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.errors import LogError
from mavstack.wire.other_formats import other_format

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from contextlib import AbstractContextManager

    from mavstack.cli.watch.observer import Observer
    from mavstack.wire import Packet

#: The path that stands for standard input.
STDIN: Final = "-"
CHUNK_SIZE: Final = 1 << 18


def read_recording(
    path: str,
    observer: Observer,
    show: Callable[[Sequence[Packet]], None] | None = None,
    duration: float | None = None,
) -> None:
    """Feed a file to an observer.

    Args:
        path: Path of the file, or `-` for standard input.
        observer: Observer of the packets.
        show: Called with the packets of each piece; None shows none.
        duration: Seconds of recorded time to read; None reads all.

    Raises:
        LogError: The file has another format, or no recorded times although `duration` needs them.
    """
    with _open(path) as file:
        head = _head(path, file)
        timestamped = looks_timestamped(head, observer.dialect)
        if duration is not None and not timestamped:
            raise LogError(f"{path}: it has no recorded times, which --for needs")
        observer.open(path, timestamped=timestamped)
        with TransferProgress(f"reading {path}") as progress:
            done, size = 0, _size(path)
            for data in _pieces(file, head):
                packets = observer.receive(path, data, observer.last_recorded or 0.0, duration)
                if show is not None and packets:
                    show(packets)
                done += len(data)
                progress(done, size)
                if observer.beyond_duration:
                    return
        packets = observer.flush(path, observer.last_recorded or 0.0)
        if show is not None and packets:
            show(packets)


def _open(path: str) -> AbstractContextManager[BinaryIO]:
    return nullcontext(sys.stdin.buffer) if path == STDIN else Path(path).open("rb")


def _size(path: str) -> int:
    return 0 if path == STDIN else Path(path).stat().st_size


def _head(path: str, file: BinaryIO) -> bytes:
    head = _read(file)
    other = other_format(head)
    if other is not None:
        raise LogError(f"{path}: this is {other}, not a stream of MAVLink packets")
    return head


def _pieces(file: BinaryIO, head: bytes) -> Iterator[bytes]:
    data = head
    while data:
        yield data
        data = _read(file)


def _read(file: BinaryIO) -> bytes:
    """Read the available data, so that a pipe is followed as it is written."""
    read_available: Callable[[int], bytes] = getattr(file, "read1", file.read)
    return read_available(CHUNK_SIZE)
