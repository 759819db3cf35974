"""Ctrl-C during imports.

KeyboardInterrupt in the middle of an import comes out of whatever the module was doing, sometimes as another
error, and in any case as a traceback.
"""

from __future__ import annotations

import signal
import threading
from contextlib import contextmanager

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def ended_by_sigint() -> Iterator[None]:
    """Let SIGINT end the process at once in a block; a handler of the program stays.

    Yields:
        None.
    """
    usual = signal.default_int_handler
    if (
        threading.current_thread() is not threading.main_thread()
        or signal.getsignal(signal.SIGINT) is not usual
    ):
        yield
        return
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
