"""Ctrl-C in tests: the handler that raises KeyboardInterrupt, also where SIGINT was ignored at the start.

A shell starts background jobs with SIGINT ignored; a test that waits for a KeyboardInterrupt would then never
end.
"""

from __future__ import annotations

import signal
from contextlib import contextmanager
from threading import Timer, main_thread
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def keyboard_interrupts() -> Iterator[None]:
    """Let SIGINT raise KeyboardInterrupt while the block runs."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def interrupt_main_thread(after: float = 0.0) -> None:
    """Send SIGINT to the main thread, after some seconds."""
    main = main_thread().ident
    assert main is not None
    if after:
        Timer(after, signal.pthread_kill, (main, signal.SIGINT)).start()
    else:
        signal.pthread_kill(main, signal.SIGINT)
