"""Lines of standard input, read while a command runs.

A thread reads them: a terminal that is made non-blocking for the event loop becomes non-blocking for every
program that prints to it, and an event loop cannot wait for a regular file. The thread reads the descriptor
itself and ends with the process.

A process in the background of a shell that reads the terminal is stopped by SIGTTIN. The thread blocks this
signal, so that the read fails instead, and tries again until the process is in the foreground.
"""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from contextlib import suppress
from threading import Semaphore, Thread
from time import sleep
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

_MAX_CHUNK: Final = 4096
#: Maximum number of chunks that wait; then the thread waits, and with it the program that writes.
_MAX_WAITING: Final = 64
#: Maximum number of bytes of a line; a longer line is cut into several.
_MAX_LINE: Final = 1 << 20
#: Seconds between two checks of a background process whether it is in the foreground now.
_FOREGROUND_INTERVAL: Final = 0.2


async def stdin_lines() -> AsyncIterator[str]:
    """Yield the lines of standard input until it ends; none if there is no standard input."""
    try:
        descriptor = sys.stdin.fileno()
    except (AttributeError, ValueError, OSError):
        return
    loop = asyncio.get_running_loop()
    chunks: asyncio.Queue[bytes] = asyncio.Queue()
    room = Semaphore(_MAX_WAITING)

    def read() -> None:
        if sys.platform != "win32":
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTTIN})
        with suppress(RuntimeError):  # the event loop is closed
            while room.acquire():
                data = _read(descriptor)
                loop.call_soon_threadsafe(chunks.put_nowait, data)
                if not data:
                    return

    Thread(target=read, name="mavstack-stdin", daemon=True).start()
    rest = b""
    while data := await chunks.get():
        room.release()
        *lines, rest = (rest + data).split(b"\n")
        if len(rest) > _MAX_LINE:
            lines, rest = [*lines, rest], b""
        for line in lines:
            yield line.decode(errors="replace")
    if rest:
        yield rest.decode(errors="replace")


def is_in_background() -> bool:
    """Return whether standard input is a terminal that belongs to another process group now."""
    try:
        return _is_in_background(sys.stdin.fileno())
    except (AttributeError, ValueError, OSError):
        return False


def _read(descriptor: int) -> bytes:
    while True:
        try:
            return os.read(descriptor, _MAX_CHUNK)
        except OSError:
            if not _is_in_background(descriptor):
                return b""
        sleep(_FOREGROUND_INTERVAL)


def _is_in_background(descriptor: int) -> bool:
    if sys.platform == "win32":
        return False
    try:
        return os.tcgetpgrp(descriptor) != os.getpgrp()
    except OSError:  # stdin is not a terminal, or is the terminal of another session
        return False
