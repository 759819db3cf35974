"""The phases of flashing, and the callback that follows them."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from typing import TypeAlias


class Phase(StrEnum):
    """A phase of flashing, in order."""

    CONNECT = "connect"
    BACKUP = "save parameters"
    BOOTLOADER = "start bootloader"
    CHECK = "check"
    ERASE_EXTERNAL = "erase external flash"
    PROGRAM_EXTERNAL = "program external flash"
    ERASE = "erase"
    PROGRAM = "program"
    VERIFY = "verify"
    REBOOT = "reboot"
    RESTORE = "restore parameters"
    DONE = "done"


#: Called with a phase, the completed units, and their total; 0: the total is unknown.
ReportProgress: TypeAlias = Callable[[Phase, int, int], None]


def no_progress(phase: Phase, done: int, total: int) -> None:
    """Ignore the progress."""
