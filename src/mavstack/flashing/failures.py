"""The errors of flashing, a part of the tree of `mavstack.errors`."""

from __future__ import annotations

from mavstack.errors import LocatedError, MavstackError


class FirmwareFileError(LocatedError):
    """A firmware file is damaged, or of an unknown format."""


class FlashingError(MavstackError):
    """Flashing failed; the text names the board or the port, the reason and the remedy."""


class FlashingRefused(FlashingError):  # noqa: N818 (as ActionRefused)
    """The firmware does not fit the board, or the vehicle cannot be flashed now; nothing was erased."""


class BootloaderError(FlashingError):
    """A bootloader refused a request, or did not answer it.

    Attributes:
        status: The status byte of its answer; None if it did not answer.
    """

    def __init__(self, text: str, status: int | None = None) -> None:
        self.status = status
        super().__init__(text)
