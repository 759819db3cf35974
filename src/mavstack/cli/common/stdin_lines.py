"""Lines of standard input, read while a command runs.

A thread reads them: a terminal that is made non-blocking for the event loop becomes non-blocking for every
program that prints to it, and an event loop cannot wait for a regular file. The thread reads the descriptor
itself and ends with the process.
"""

from __future__ import annotations

import asyncio
import os
import sys
from contextlib import suppress
from threading import Thread
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

_MAX_CHUNK: Final = 4096


async def stdin_lines() -> AsyncIterator[str]:
    """Yield the lines of standard input until it ends; none if there is no standard input."""
    try:
        descriptor = sys.stdin.fileno()
    except (AttributeError, ValueError, OSError):
        return
    loop = asyncio.get_running_loop()
    chunks: asyncio.Queue[bytes] = asyncio.Queue()

    def read() -> None:
        with suppress(RuntimeError):  # the loop is closed
            while True:
                try:
                    data = os.read(descriptor, _MAX_CHUNK)
                except OSError:
                    data = b""
                loop.call_soon_threadsafe(chunks.put_nowait, data)
                if not data:
                    return

    Thread(target=read, name="mavstack-stdin", daemon=True).start()
    rest = b""
    while data := await chunks.get():
        *lines, rest = (rest + data).split(b"\n")
        for line in lines:
            yield line.decode(errors="replace")
    if rest:
        yield rest.decode(errors="replace")
