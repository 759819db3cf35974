"""An exclusive lock between processes, for the time in which a file is read, changed and replaced.

The lock is held on a second file beside it, because a replaced file is no longer the one that was locked. The
system releases the lock of a process that is killed.
"""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager
from time import monotonic, sleep
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

#: Seconds to wait for the lock: another process holds it for milliseconds, unless it is suspended.
LOCK_TIMEOUT: Final = 1.0
_RETRY_INTERVAL: Final = 0.001
_OPEN_FLAGS: Final = os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_NOFOLLOW", 0)


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold the lock of a file for the length of a block.

    Args:
        path: The file; the lock is on a file beside it, whose name ends with `.lock` and which remains.

    Yields:
        None.

    Raises:
        OSError: The lock file cannot be created.
        TimeoutError: Another process holds the lock for longer than `LOCK_TIMEOUT`.
    """
    descriptor = os.open(path.with_name(path.name + ".lock"), _OPEN_FLAGS, 0o600)
    try:
        _wait_for_lock(descriptor)
        try:
            yield
        finally:
            _unlock(descriptor)
    finally:
        os.close(descriptor)


def _wait_for_lock(descriptor: int) -> None:
    deadline = monotonic() + LOCK_TIMEOUT
    while not _try_lock(descriptor):
        if monotonic() > deadline:
            raise TimeoutError("another process has locked it")
        sleep(_RETRY_INTERVAL)


if sys.platform == "win32":
    import msvcrt

    def _try_lock(descriptor: int) -> bool:
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True

    def _unlock(descriptor: int) -> None:
        os.lseek(descriptor, 0, os.SEEK_SET)
        msvcrt.locking(descriptor, msvcrt.LK_UNLCK, 1)

else:
    import fcntl

    def _try_lock(descriptor: int) -> bool:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True

    def _unlock(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_UN)
