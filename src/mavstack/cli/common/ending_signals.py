"""SIGTERM and SIGHUP that end a command as Ctrl-C does: its links are closed, and what it linked is removed.

By default these signals end a process at once. The name `/tmp/ttyDrone` of a link would lead to a terminal
that the system gives to another program next: what is written to the link would be typed there.
"""

from __future__ import annotations

import signal
import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import FrameType

#: SIGHUP: the terminal of the command was closed; other systems have none.
_NAMES: Final = ("SIGTERM", "SIGHUP")


@contextmanager
def ending_like_ctrl_c() -> Iterator[None]:
    """Let SIGTERM and SIGHUP end a block as Ctrl-C does; a handler of the program, or none (`nohup`), stays.

    Yields:
        None.

    Raises:
        SystemExit: One of them ended the block; its code is 128 and the number of the signal, as of a shell.
    """
    received: list[int] = []

    def end(number: int, _: FrameType | None) -> None:
        received.append(number)
        if callable(signal.getsignal(signal.SIGINT)):
            signal.raise_signal(signal.SIGINT)  # an event loop cancels its task
        else:  # a shell ignores SIGINT in background jobs
            raise KeyboardInterrupt

    numbers = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]
    is_main = threading.current_thread() is threading.main_thread()
    taken = [number for number in numbers if is_main and signal.getsignal(number) is signal.SIG_DFL]
    for number in taken:
        signal.signal(number, end)
    try:
        yield
    except KeyboardInterrupt:
        if received:
            raise SystemExit(128 + received[0]) from None
        raise
    finally:
        for number in taken:
            signal.signal(number, signal.SIG_DFL)
