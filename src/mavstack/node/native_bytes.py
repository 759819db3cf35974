"""The reading of one link by a thread of the core, for programs that parse its bytes themselves.

The thread reads the socket in batches and joins the datagrams of a sender. While many come, the program takes
them at fixed intervals, so that its cost does not grow with their number.
"""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Final

from mavstack._core import Intake
from mavstack.node.message_fields import HEADING_FIELDS, POSITION_FIELDS
from mavstack.node.native_input import is_possible

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mavstack.dialects import Dialect
    from mavstack.links import Link
    from mavstack.links.native_reading import NativeReading

#: Seconds between two reads of the received data while many datagrams arrive.
_INTERVAL: Final = 0.002
_LINK: Final = 0


@asynccontextmanager
async def read_natively(link: Link, dialect: Dialect) -> AsyncIterator[None]:
    """Let a thread read an open link while the block runs, if the link and the event loop allow that.

    Args:
        link: The link, which passes on what is received as ever.
        dialect: The dialect of its messages.

    Yields:
        Nothing.
    """
    reader = _Reader(dialect) if is_possible(asyncio.get_running_loop()) else None
    if reader is None or not reader.start(link):
        yield
        return
    try:
        yield
    finally:
        reader.stop()


class _Reader:
    """The thread, and the looks of the event loop at what it has read."""

    def __init__(self, dialect: Dialect) -> None:
        self._loop = asyncio.get_running_loop()
        self._intake = Intake(dialect, {}, POSITION_FIELDS, HEADING_FIELDS)
        self._reading: NativeReading | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._descriptor = -1

    def start(self, link: Link) -> bool:
        """Start the thread; return whether it reads the link."""
        self._descriptor = self._intake.start(self._loop.time())
        self._reading = link.read_natively(self._intake, _LINK)
        if self._reading is None:
            self._intake.stop()
            return False
        self._loop.add_reader(self._descriptor, self._on_readable)
        return True

    def stop(self) -> None:
        """Take the rest, and end the thread."""
        if self._reading is not None:
            self._reading.stop()
            self._deliver(self._reading)
        if self._timer is not None:
            self._timer.cancel()
        self._loop.remove_reader(self._descriptor)
        self._intake.stop()

    def _on_readable(self) -> None:
        self._loop.remove_reader(self._descriptor)
        self._look()

    def _look(self) -> None:
        self._timer = None
        if self._reading is not None and self._deliver(self._reading):
            self._timer = self._loop.call_later(_INTERVAL, self._look)
        else:
            self._loop.add_reader(self._descriptor, self._on_readable)

    def _deliver(self, reading: NativeReading) -> bool:
        """Pass what was read to the link; return whether there was any."""
        _, datagrams, _, overloaded, _ = self._intake.take()
        for _, address, data, count in datagrams:
            reading.receive(data, address, count)
        if overloaded:
            reading.take_over()
        return bool(datagrams)
