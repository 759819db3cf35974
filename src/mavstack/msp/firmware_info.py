"""The identity of a flight controller, on which layouts of messages and settings depend."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

BETAFLIGHT: Final = "BTFL"
INAV: Final = "INAV"
_NAMES: Final = {BETAFLIGHT: "Betaflight", INAV: "iNav"}


@dataclass(frozen=True, slots=True)
class FirmwareInfo:
    """The identity of a flight controller.

    Attributes:
        variant: Four letters: `BTFL` for Betaflight, `INAV` for iNav, or those of another firmware.
        version: Version of the firmware, (4, 5, 1); releases since 2025 are (25, 12, 0).
        api: Version of the MSP interface, (1, 46).
        board: Identifier of the board, four letters.
        target: Name of the target for which the firmware was built.
        build: Date, time and revision of the build.
        name: The name of the craft, set by its user.
        uid: Unique identifier of the processor, in hexadecimal digits.
        release: The version as text, with suffixes such as `-alpha`; empty below API 1.47 and for iNav.
    """

    variant: str
    version: tuple[int, int, int] = (0, 0, 0)
    api: tuple[int, int] = (0, 0)
    board: str = ""
    target: str = ""
    build: str = ""
    name: str = ""
    uid: str = ""
    release: str = ""

    @property
    def firmware(self) -> str:
        """The name of the firmware; of an unknown one its variant."""
        return _NAMES.get(self.variant, self.variant)

    @property
    def version_text(self) -> str:
        """The version as its makers write it: "4.5.1", "2025.12.0", "2026.12.0-alpha"."""
        if self.release:
            return self.release
        major, minor, patch = self.version
        is_calendar = self.variant == BETAFLIGHT and major >= 25
        return f"{major + 2000 if is_calendar else major}.{minor}.{patch}"

    @property
    def is_betaflight(self) -> bool:
        """True for Betaflight."""
        return self.variant == BETAFLIGHT

    @property
    def is_inav(self) -> bool:
        """True for iNav."""
        return self.variant == INAV
