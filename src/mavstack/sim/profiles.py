"""Selection of the firmware profile."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.ardupilot import ArdupilotProfile
from mavstack.sim.px4 import Px4Profile
from mavstack.sim.vehicle_types import Firmware

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import FirmwareProfile
    from mavstack.sim.vehicle_types import VehicleType


def profile_of(firmware: Firmware, vehicle_type: VehicleType) -> FirmwareProfile:
    """Return the profile of a firmware on a vehicle type."""
    return Px4Profile(vehicle_type) if firmware is Firmware.PX4 else ArdupilotProfile(vehicle_type)
