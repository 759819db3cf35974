"""The options of flashing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.flashing.progress import ReportProgress, no_progress

if TYPE_CHECKING:
    from pathlib import Path


@dataclass(frozen=True, slots=True, kw_only=True)
class FlashOptions:
    """The options of flashing.

    Attributes:
        dry_run: Only check, and write nothing.
        keep_parameters: Save the parameters before and restore them after.
        backup_folder: The folder of saved parameters; None: that of the user's state.
        radio_board: The board of a radio, if the name of its firmware file does not say.
        report: Called with the phase and the units done and in total.
    """

    dry_run: bool = False
    keep_parameters: bool = True
    backup_folder: Path | None = None
    radio_board: str | None = None
    report: ReportProgress = no_progress
