"""SIGTERM and SIGHUP that end a command as Ctrl-C does: its links are closed, and what it linked is removed.

By default these signals end a process at once. The name `/tmp/ttyDrone` of a link would lead to a terminal
that the system gives to another program next: what is written to the link would be typed there.
"""

from __future__ import annotations

import asyncio
import signal
import sys
import threading
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, Any, Final, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Iterator, Mapping

Result = TypeVar("Result")

#: The signals that end a command. SIGHUP: its terminal was closed; Windows does not have this signal.
_NAMES: Final = ("SIGTERM", "SIGHUP")


def run_until_signal(work: Coroutine[Any, Any, Result]) -> Result:
    """Run a coroutine in an event loop of its own; SIGTERM and SIGHUP cancel it, and it ends in order.

    A handler of the program stays, as does a signal that is ignored (`nohup`).

    Args:
        work: The coroutine.

    Returns:
        Its result.

    Raises:
        SystemExit: A signal ended it; its code is 128 and the number of the signal, as of a shell.
    """
    received: list[int] = []
    try:
        result = asyncio.run(_cancelled_by_signals(work, received))
    except asyncio.CancelledError:
        if received:
            sys.exit(128 + received[0])
        raise
    if received:
        sys.exit(128 + received[0])
    return result


async def _cancelled_by_signals(work: Coroutine[Any, Any, Result], received: list[int]) -> Result:
    loop = asyncio.get_running_loop()
    task = loop.create_task(work)

    def end(number: int) -> None:
        received.append(number)
        task.cancel()

    with calling_on_signals({number: partial(end, number) for number in _default_signals()}):
        return await task


@contextmanager
def calling_on_signals(callbacks: Mapping[signal.Signals, Callable[[], object]]) -> Iterator[None]:
    """Call functions in the event loop when signals come, while the block runs.

    Unlike `loop.add_signal_handler` it works on Windows, and does not need `inspect`, a large module.
    The handlers before it return at the end.

    Args:
        callbacks: The functions by signal.
    """
    loop = asyncio.get_running_loop()
    previous = {
        number: signal.signal(number, lambda *_, call=call: loop.call_soon_threadsafe(call))
        for number, call in callbacks.items()
    }
    try:
        yield
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)


def _default_signals() -> list[signal.Signals]:
    """Return the signals that would end this process at once."""
    if threading.current_thread() is not threading.main_thread():
        return []
    numbers = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]
    return [number for number in numbers if signal.getsignal(number) is signal.SIG_DFL]
