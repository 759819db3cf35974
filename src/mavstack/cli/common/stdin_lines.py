"""Lines that are typed while a command runs.

A thread reads them: a terminal that is made non-blocking for an event loop is so for everything that prints
to it, and files cannot be waited for at all. The thread reads the descriptor itself and ends with the
process.
"""

from __future__ import annotations

import asyncio
import os
import sys
from contextlib import suppress
from threading import Thread
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

_MOST = 4096


async def typed_lines() -> AsyncIterator[str]:
    """The lines of standard input as they come, until it ends; none if there is no such thing."""
    try:
        descriptor = sys.stdin.fileno()
    except (AttributeError, ValueError, OSError):
        return
    loop = asyncio.get_running_loop()
    chunks: asyncio.Queue[bytes] = asyncio.Queue()

    def read() -> None:
        with suppress(RuntimeError):  # the loop has ended meanwhile
            while True:
                try:
                    data = os.read(descriptor, _MOST)
                except OSError:
                    data = b""
                loop.call_soon_threadsafe(chunks.put_nowait, data)
                if not data:
                    return

    Thread(target=read, name="mavstack-typed", daemon=True).start()
    rest = b""
    while data := await chunks.get():
        *lines, rest = (rest + data).split(b"\n")
        for line in lines:
            yield line.decode(errors="replace")
    if rest:
        yield rest.decode(errors="replace")
