"""The reaction of a running command to Ctrl-C."""

from __future__ import annotations

import asyncio
import signal
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


@contextmanager
def on_interrupt(act: Callable[[], object]) -> Iterator[None]:
    """Call `act` in the event loop at each Ctrl-C while the block runs."""
    loop = asyncio.get_running_loop()
    previous = signal.getsignal(signal.SIGINT)

    def schedule_act(*_: object) -> None:
        loop.call_soon_threadsafe(act)

    try:
        loop.add_signal_handler(signal.SIGINT, act)
    except (NotImplementedError, RuntimeError, ValueError):  # Windows, or not the main thread
        try:
            signal.signal(signal.SIGINT, schedule_act)
        except ValueError:  # only the main thread receives signals
            yield
            return
    try:
        yield
    finally:
        with suppress(NotImplementedError):
            loop.remove_signal_handler(signal.SIGINT)
        signal.signal(signal.SIGINT, previous)
