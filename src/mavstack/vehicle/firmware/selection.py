"""Which firmware a vehicle has, by its heartbeat."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.vehicle.firmware.ardupilot import ArduPilot
from mavstack.vehicle.firmware.firmware import Firmware
from mavstack.vehicle.firmware.px4 import Px4

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.vehicle import Vehicle

_KNOWN: Final[Mapping[int, type[Firmware]]] = MappingProxyType(
    {common.MavAutopilot.ARDUPILOTMEGA: ArduPilot, common.MavAutopilot.PX4: Px4}
)


def firmware_of(vehicle: Vehicle) -> Firmware:
    """How to ask this vehicle; one of a firmware that is not known is asked by what is standard."""
    return _KNOWN.get(vehicle.autopilot, Firmware)(vehicle)
