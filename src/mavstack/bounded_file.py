"""Files that are read up to a maximum size, and never waited for."""

from __future__ import annotations

import os

_FLAGS = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0)


def read_file_bounded(path: str | os.PathLike[str], size: int) -> bytes:
    """Read a file, or its beginning if it is larger.

    A FIFO without a writer is empty, where `open` alone would wait for a writer without end.

    Args:
        path: The file.
        size: The maximum number of bytes.

    Returns:
        The content.

    Raises:
        OSError: The file cannot be read.
        ValueError: The path contains a NUL.
    """
    with open(path, "rb", opener=_open) as file:
        return file.read(size)


def _open(path: str, flags: int) -> int:
    descriptor = os.open(path, flags | _FLAGS)
    if _FLAGS:
        os.set_blocking(descriptor, True)  # a blocking read waits for the end of a pipe that has a writer
    return descriptor
