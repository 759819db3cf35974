"""The interval of a node's looks at its sockets, for programs that pass many packets on.

A wake-up of the event loop costs more than the handling of a packet. A program that may deliver packets a
moment later takes those of this moment together. Only packets that follow another one within the interval
wait, so packets that come seldom are not delayed; nor are those that come while an answer is awaited.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


class InputInterval:
    """The looks at the sockets while packets come fast.

    Args:
        seconds: Seconds between two looks; 0: the event loop wakes for each packet.
        look: Takes what waits; returns whether there was anything.
        watch: Lets the event loop wait for the sockets, or ends it.
    """

    def __init__(self, seconds: float, look: Callable[[], bool], watch: Callable[[bool], None]) -> None:
        self._seconds = seconds
        self._look = look
        self._watch = watch
        self._loop = asyncio.get_running_loop()
        self._timer: asyncio.TimerHandle | None = None
        self._read_at = -seconds
        self._hurry_until = 0.0

    def begin(self) -> None:
        """Begin to look at intervals if the last packets came fast; called after the sockets were read."""
        if not self._seconds or self._timer is not None:
            return
        now = self._loop.time()
        if now - self._read_at < self._seconds and now >= self._hurry_until:
            self._watch(False)
            self._timer = self._loop.call_later(self._seconds, self._on_timer)
        self._read_at = now

    def hurry(self, seconds: float) -> None:
        """Let no packet wait for some time."""
        if self._seconds:
            self._hurry_until = self._loop.time() + seconds
            if self._timer is not None:
                self.end()
                self._watch(True)

    def end(self) -> None:
        """Look no more; the caller decides who waits for the sockets."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _on_timer(self) -> None:
        self._timer = self._loop.call_later(self._seconds, self._on_timer)
        if not self._look() and self._timer is not None:
            self.end()
            self._watch(True)
