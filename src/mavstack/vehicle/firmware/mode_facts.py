"""The uses of modes as one table of plain values, which the page is built from."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.modes import mode_name, mode_number
from mavstack.vehicle.firmware.ardupilot import ArduPilot
from mavstack.vehicle.firmware.px4 import Px4
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.firmware.firmware import Firmware

_T: Final = common.MavType
#: One MAV_TYPE for each vehicle type that has modes.
_MAV_TYPES: Final[Mapping[VehicleType, int]] = MappingProxyType(
    {
        VehicleType.COPTER: _T.QUADROTOR,
        VehicleType.PLANE: _T.FIXED_WING,
        VehicleType.VTOL: _T.VTOL_TILTROTOR,
        VehicleType.ROVER: _T.GROUND_ROVER,
        VehicleType.BOAT: _T.SURFACE_BOAT,
        VehicleType.SUB: _T.SUBMARINE,
    }
)
_FIRMWARES: Final[Mapping[int, type[Firmware]]] = MappingProxyType(
    {common.MavAutopilot.ARDUPILOTMEGA: ArduPilot, common.MavAutopilot.PX4: Px4}
)


def mode_facts() -> dict[str, dict[str, dict[str, list[str] | str]]]:
    """Return the uses of modes by firmware and vehicle type.

    Returns:
        For "ardupilot" and "px4": lists of modes under "noArming" and "selfStarting", one mode under
        "waiting", "hold" and "land", each by vehicle type; all modes by the names that HEARTBEAT stands for.
    """
    return {firmware.NAME.lower(): _facts(autopilot, firmware) for autopilot, firmware in _FIRMWARES.items()}


def _facts(autopilot: int, firmware: type[Firmware]) -> dict[str, dict[str, list[str] | str]]:
    lists = {"noArming": firmware.NO_ARMING_MODES, "selfStarting": firmware.SELF_STARTING_MODES}
    single = {"waiting": firmware.WAITING_MODES, "hold": firmware.HOLD_MODES, "land": firmware.LAND_MODES}
    facts: dict[str, dict[str, list[str] | str]] = {
        use: {
            kind.name.lower(): sorted(_named(autopilot, kind, mode) for mode in table[kind])
            for kind in _MAV_TYPES
            if kind in table
        }
        for use, table in lists.items()
    }
    for use, modes in single.items():
        facts[use] = {
            kind.name.lower(): _named(autopilot, kind, modes[kind]) for kind in _MAV_TYPES if kind in modes
        }
    return facts


def _named(autopilot: int, kind: VehicleType, mode: str) -> str:
    """Return the one name of a mode; a mode that the tables of names lack keeps its name."""
    mav_type = _MAV_TYPES[kind]
    number = mode_number(autopilot, mav_type, mode)
    return (None if number is None else mode_name(autopilot, mav_type, number)) or mode.upper()
