"""The selection of a firmware class by the MAV_AUTOPILOT of a heartbeat."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.vehicle.firmware.ardupilot import ArduPilot
from mavstack.vehicle.firmware.firmware import Firmware
from mavstack.vehicle.firmware.px4 import Px4

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.firmware.interface import FirmwareVehicle

_CLASSES: Final[Mapping[int, type[Firmware]]] = MappingProxyType(
    {common.MavAutopilot.ARDUPILOTMEGA: ArduPilot, common.MavAutopilot.PX4: Px4}
)


def firmware_class(autopilot: int | None) -> type[Firmware]:
    """Return the class of a MAV_AUTOPILOT; `Firmware`, which keeps to the standard, if it is not known."""
    return Firmware if autopilot is None else _CLASSES.get(autopilot, Firmware)


def firmware_of(vehicle: FirmwareVehicle) -> Firmware:
    """Return the firmware of a vehicle, by the MAV_AUTOPILOT of its last heartbeat."""
    return firmware_class(vehicle.autopilot)(vehicle)
