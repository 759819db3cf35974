"""The status of a running recording: one line on a terminal, nothing in a pipe."""

from __future__ import annotations

import asyncio
import sys
from time import monotonic
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import echo_progress
from mavstack.cli.common.text import size_text
from mavstack.cli.watch.snapshot import elapsed_text, rate_text

if TYPE_CHECKING:
    from typing import Self

    from mavstack.cli.watch.observation import Observation

_INTERVAL: Final = 0.5


class RecordingStatus:
    """The status line of a recording; a context manager that clears it."""

    def __init__(self, observation: Observation) -> None:
        self._observation = observation
        self._started = self._measured = monotonic()
        self._packets = 0
        self._rate = 0.0
        self._enabled = sys.stderr.isatty()

    async def run(self) -> None:
        """Draw until cancelled."""
        while True:
            await asyncio.sleep(_INTERVAL)
            if self._enabled:
                echo_progress(self.text(monotonic()))

    def text(self, now: float) -> str:
        """Return the line at a time of the monotonic clock."""
        recorder = self._observation.recorder
        if recorder is None:
            return ""
        if now > self._measured:
            self._rate = (recorder.packets - self._packets) / (now - self._measured)
            self._measured, self._packets = now, recorder.packets
        elapsed = elapsed_text(now - self._started)
        counts = f"{recorder.packets} packets, {size_text(recorder.bytes)}"
        return f"{recorder.path}: {counts}, {rate_text(self._rate)} packets/s, {elapsed} · Ctrl-C ends"

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._enabled:
            echo_progress("")
