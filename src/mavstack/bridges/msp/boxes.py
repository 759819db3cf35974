"""The boxes of a flight controller as flight modes of MAVLink.

A box is a mode or a switch of Betaflight or iNav: ARM, ANGLE, BEEPER, NAV RTH. Each has a permanent id; the
controller lists those that it has (MSP_BOXIDS, MSP_BOXNAMES), and reports the active ones as bits in the
order of that list (MSP_STATUS_EX). Several boxes may be active at once, while MAVLink has one mode. The mode
of the bridge is therefore the active flight mode with the highest precedence; without one it is ACRO.

`custom_mode` is the permanent id of the box, and 0 for ACRO: 0 is the id of ARM, which is no mode. The names
are those of the firmware.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.modes import AvailableMode

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

#: `custom_mode` and mode name while no flight mode is active.
ACRO: Final = 0
ACRO_NAME: Final = "ACRO"

#: Permanent box ids that are equal in both firmwares.
ARM: Final = 0
BEEPER: Final = 13
FAILSAFE: Final = 27

_STANDARD: Final = common.MavStandardMode
_HIDDEN: Final = int(common.MavModeProperty.NOT_USER_SELECTABLE)
_ADVANCED: Final = int(common.MavModeProperty.ADVANCED)


@dataclass(frozen=True, slots=True)
class _FlightMode:
    """The meaning of a box as a flight mode."""

    standard_mode: int = _STANDARD.NON_STANDARD
    properties: int = 0


#: The flight modes of Betaflight by permanent id, highest precedence first.
_BETAFLIGHT: Final[Mapping[int, _FlightMode]] = MappingProxyType(
    {
        FAILSAFE: _FlightMode(properties=_HIDDEN),
        35: _FlightMode(properties=_ADVANCED),  # FLIP OVER AFTER CRASH
        46: _FlightMode(_STANDARD.SAFE_RECOVERY),  # GPS RESCUE
        56: _FlightMode(),  # AUTOPILOT
        11: _FlightMode(_STANDARD.POSITION_HOLD),  # POS HOLD
        3: _FlightMode(_STANDARD.ALTITUDE_HOLD),  # ALTHOLD
        12: _FlightMode(),  # PASSTHRU
        55: _FlightMode(properties=_ADVANCED),  # CHIRP
        1: _FlightMode(),  # ANGLE
        2: _FlightMode(),  # HORIZON
        47: _FlightMode(),  # ACRO TRAINER
        49: _FlightMode(properties=_ADVANCED),  # LAUNCH CONTROL
    }
)
#: The flight modes of iNav by permanent id, highest precedence first.
_INAV: Final[Mapping[int, _FlightMode]] = MappingProxyType(
    {
        FAILSAFE: _FlightMode(properties=_HIDDEN),
        52: _FlightMode(properties=_ADVANCED),  # TURTLE
        10: _FlightMode(_STANDARD.SAFE_RECOVERY),  # NAV RTH
        28: _FlightMode(_STANDARD.MISSION),  # NAV WP
        36: _FlightMode(),  # NAV LAUNCH
        53: _FlightMode(_STANDARD.CRUISE),  # NAV CRUISE
        45: _FlightMode(),  # NAV COURSE HOLD
        11: _FlightMode(_STANDARD.POSITION_HOLD),  # NAV POSHOLD
        3: _FlightMode(_STANDARD.ALTITUDE_HOLD),  # NAV ALTHOLD
        12: _FlightMode(),  # MANUAL
        64: _FlightMode(),  # ANGLE HOLD
        1: _FlightMode(),  # ANGLE
        2: _FlightMode(),  # HORIZON
    }
)


class Boxes:
    """The boxes of one flight controller.

    Args:
        is_inav: True for iNav, False for Betaflight and its relatives.
        ids: The permanent ids in the order of the status bits.
        names: The names in the same order; missing ones are numbered.
    """

    def __init__(self, *, is_inav: bool, ids: Sequence[int], names: Sequence[str] = ()) -> None:
        self.ids = tuple(ids)
        self._names = {box: _printable(name) for box, name in zip(self.ids, names, strict=False)}
        self._flight_modes = _INAV if is_inav else _BETAFLIGHT

    def __contains__(self, permanent_id: object) -> bool:
        return permanent_id in self.ids

    def name(self, permanent_id: int) -> str:
        """Return the name of a box."""
        return self._names.get(permanent_id, f"BOX {permanent_id}")

    def active(self, positions: Iterable[int]) -> frozenset[int]:
        """Return the permanent ids of the boxes at positions of the list, which are the bits of a status."""
        return frozenset(self.ids[position] for position in positions if position < len(self.ids))

    def modes(self) -> list[AvailableMode]:
        """Return the flight modes that the controller has, ACRO first."""
        found = [
            AvailableMode(box, self.name(box), mode.standard_mode, mode.properties)
            for box, mode in self._flight_modes.items()
            if box in self.ids
        ]
        return [AvailableMode(ACRO, ACRO_NAME), *sorted(found, key=lambda mode: mode.custom_mode)]

    def custom_mode(self, active: frozenset[int]) -> int:
        """Return the flight mode with the highest precedence of the active boxes."""
        return next((box for box in self._flight_modes if box in active and box in self.ids), ACRO)

    def flight_modes(self) -> frozenset[int]:
        """Return the permanent ids of the flight modes that a pilot can select."""
        modes = self._flight_modes.items()
        return frozenset(box for box, mode in modes if box in self.ids and not mode.properties & _HIDDEN)


def _printable(name: str) -> str:
    """Return a name with a question mark for each character that is not printable ASCII."""
    return "".join(letter if letter.isascii() and letter.isprintable() else "?" for letter in name)
