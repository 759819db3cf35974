"""The run of `mav watch --tui`: links are followed while the window is open."""

from __future__ import annotations

import asyncio
import signal
import sys
from contextlib import contextmanager, suppress
from functools import partial
from time import monotonic
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.log_output import stderr_log_held
from mavstack.cli.watch.inspector.model import Inspector
from mavstack.cli.watch.link_follower import background_tasks
from mavstack.cli.watch.observation import Observation
from mavstack.errors import MissingExtraError

try:
    from mavstack.cli.watch.inspector.window import InspectorWindow
except ImportError:
    raise MissingExtraError("mav watch --tui", "tui") from None

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Iterator, Sequence

    from mavstack.cli.watch.sources import WatchedSource
    from mavstack.cli.watch.trend import FieldPatterns
    from mavstack.wire import Packet

#: Signals that close the window. asyncio's SIGINT handler cancels the task: a normal end for Textual.
_ENDING_SIGNALS: Final = (signal.SIGINT, signal.SIGTERM)


async def inspect_sources(
    sources: Sequence[WatchedSource], arguments: Namespace, patterns: FieldPatterns | None
) -> int:
    """Follow the links of the sources in a window until the user quits; return the exit code.

    Raises:
        UsageError: There is no terminal.
        LinkError: A link cannot be opened.
        LogError: The recording cannot be written.
    """
    if not all(stream.isatty() for stream in (sys.stdin, sys.stdout, sys.stderr)):  # Textual writes to stderr
        raise UsageError("--tui needs a terminal; in a pipe use --once, --json or no option")
    observation = Observation(sources, arguments)
    inspector = Inspector(sources, arguments.sort, patterns, lambda: observation.activity)
    for source in sources:
        source.follower.show = partial(_receive, inspector, source.label)
    window = InspectorWindow(inspector)
    try:
        async with observation:
            follow = _follow(observation, window, arguments.seconds)
            with stderr_log_held(), _closed_by_signals(window):
                async with background_tasks(*observation.jobs(), follow):
                    code = await window.run_async()
    finally:
        observation.report_activity()
    return code or 0


def _receive(inspector: Inspector, label: str, packets: Sequence[Packet], time: float) -> None:
    inspector.receive(label, packets, time, monotonic())


async def _follow(observation: Observation, window: InspectorWindow, duration: float | None) -> None:
    """Follow the links; the window stays when they end, unless the user gave a duration."""
    await observation.run(duration)
    window.inspector.has_ended = True
    if duration is not None:
        window.exit(0)


@contextmanager
def _closed_by_signals(window: InspectorWindow) -> Iterator[None]:
    """Close the window on SIGINT and SIGTERM, so that the terminal is left as it was."""
    loop = asyncio.get_running_loop()
    with suppress(NotImplementedError):  # Windows has no signal handlers in event loops
        for number in _ENDING_SIGNALS:
            loop.add_signal_handler(number, window.exit, 128 + number)
    try:
        yield
    finally:
        with suppress(NotImplementedError):
            for number in _ENDING_SIGNALS:
                loop.remove_signal_handler(number)
