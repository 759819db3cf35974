"""What is told of one mode: in AVAILABLE_MODES when it is listed, in CURRENT_MODE when it is flown."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from typing import Self

NAME_BYTES = 35


@dataclass(frozen=True, slots=True)
class AvailableMode:
    """A mode that a vehicle has; `standard_mode` is NON_STANDARD if it is its autopilot's alone."""

    custom_mode: int
    name: str = ""
    standard_mode: int = common.MavStandardMode.NON_STANDARD
    properties: int = 0

    @property
    def selectable(self) -> bool:
        """Whether a user may be offered it."""
        return not self.properties & common.MavModeProperty.NOT_USER_SELECTABLE

    @property
    def advanced(self) -> bool:
        """Whether it is for experienced users."""
        return bool(self.properties & common.MavModeProperty.ADVANCED)

    def to_message(self, index: int, total: int) -> common.AvailableModes:
        """As AVAILABLE_MODES; the index begins at 1."""
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
        """The mode in AVAILABLE_MODES."""
        return cls(
            int(message.custom_mode), message.mode_name, int(message.standard_mode), int(message.properties)
        )


def _cut(name: str) -> str:
    """As much of a name as the field holds, no character cut in two."""
    return name.encode()[:NAME_BYTES].decode(errors="ignore")
