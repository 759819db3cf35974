"""The selection of a firmware class by the MAV_AUTOPILOT of a heartbeat, and by AUTOPILOT_VERSION.

Betaflight and iNav have no MAV_AUTOPILOT of their own. Their bridge sends GENERIC, and in the field
`flight_custom_version` of AUTOPILOT_VERSION the identifier by which the firmware names itself in MSP
(FC_VARIANT), four letters: "BTFL", "INAV".
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.vehicle.firmware.ardupilot import ArduPilot
from mavstack.vehicle.firmware.firmware import Firmware
from mavstack.vehicle.firmware.msp import Betaflight, Inav
from mavstack.vehicle.firmware.px4 import Px4

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.firmware.changes import Changes
    from mavstack.vehicle.vehicle import Vehicle

_CLASSES: Final[Mapping[int, type[Firmware]]] = MappingProxyType(
    {common.MavAutopilot.ARDUPILOTMEGA: ArduPilot, common.MavAutopilot.PX4: Px4}
)
_IDENTIFIED: Final[Mapping[str, type[Firmware]]] = MappingProxyType({"BTFL": Betaflight, "INAV": Inav})


def firmware_class(autopilot: int | None, identifier: str = "") -> type[Firmware]:
    """Return the class of a firmware.

    Args:
        autopilot: The MAV_AUTOPILOT of its heartbeat; None if none was received.
        identifier: The identifier in its AUTOPILOT_VERSION; empty if it has none, or none was received.

    Returns:
        The class; `Firmware`, which keeps to the standard, if the firmware is not known.
    """
    if autopilot == common.MavAutopilot.GENERIC:
        return _IDENTIFIED.get(identifier, Firmware)
    return Firmware if autopilot is None else _CLASSES.get(autopilot, Firmware)


def firmware_of(vehicle: Vehicle, changes: Changes | None = None) -> Firmware:
    """Return the firmware of a vehicle, by its last heartbeat and its AUTOPILOT_VERSION.

    Args:
        vehicle: The vehicle.
        changes: The changes of a call that this one is a part of; None: the call stands alone.

    Returns:
        The firmware, for one call.
    """
    return firmware_class(vehicle.autopilot, vehicle.identifier)(vehicle, changes)
