"""A flight mode as AVAILABLE_MODES and CURRENT_MODE describe it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from typing import Self

NAME_BYTES = 35


@dataclass(frozen=True, slots=True)
class AvailableMode:
    """A mode of a vehicle; `standard_mode` is NON_STANDARD for a mode of its firmware alone."""

    custom_mode: int
    name: str = ""
    standard_mode: int = common.MavStandardMode.NON_STANDARD
    properties: int = 0

    @property
    def selectable(self) -> bool:
        """True if users can select it."""
        return not self.properties & common.MavModeProperty.NOT_USER_SELECTABLE

    @property
    def advanced(self) -> bool:
        """True if it is for experienced users."""
        return bool(self.properties & common.MavModeProperty.ADVANCED)

    def to_message(self, index: int, total: int) -> common.AvailableModes:
        """Return the AVAILABLE_MODES; the index begins at 1."""
        return common.AvailableModes(
            number_modes=total,
            mode_index=index,
            standard_mode=self.standard_mode,
            custom_mode=self.custom_mode,
            properties=self.properties,
            mode_name=_cut(self.name),
        )

    @classmethod
    def read(cls, message: common.AvailableModes) -> Self:
        """Return the mode in an AVAILABLE_MODES."""
        return cls(
            int(message.custom_mode), message.mode_name, int(message.standard_mode), int(message.properties)
        )


def _cut(name: str) -> str:
    """Truncate a name to the field's length, between characters."""
    return name.encode()[:NAME_BYTES].decode(errors="ignore")
