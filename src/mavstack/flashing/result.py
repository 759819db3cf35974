"""The result of flashing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.flashing.backup import Restored


@dataclass(frozen=True, slots=True)
class FlashResult:
    """The result of flashing.

    Attributes:
        board: The board or radio, in words.
        written: Bytes that were written; 0 if nothing was, by `dry_run`.
        attempts: How often the firmware was written, more than once after a lost port.
        restored: The outcome of restoring the parameters; None if they were not restored.
        notes: Sentences for the user, such as where the parameters are.
    """

    board: str
    written: int = 0
    attempts: int = 1
    restored: Restored | None = None
    notes: tuple[str, ...] = ()
