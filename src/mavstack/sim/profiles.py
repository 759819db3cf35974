"""Selection of the firmware profile."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError
from mavstack.sim.ardupilot import ArdupilotProfile
from mavstack.sim.px4 import Px4Profile
from mavstack.sim.vehicle_types import Firmware

if TYPE_CHECKING:
    from mavstack.services.version import FirmwareVersion
    from mavstack.sim.autopilot.firmware_profile import FirmwareProfile
    from mavstack.sim.vehicle_types import VehicleType


def profile_of(
    firmware: Firmware, vehicle_type: VehicleType, version: FirmwareVersion | None = None
) -> FirmwareProfile:
    """Return the profile of a firmware on a vehicle type; a version is one of ArduPilot.

    Raises:
        InvalidArgumentError: PX4 has one version only.
    """
    if firmware is Firmware.PX4:
        if version is not None:
            raise InvalidArgumentError("a version can be chosen for simulated ArduPilot vehicles only")
        return Px4Profile(vehicle_type)
    return ArdupilotProfile(vehicle_type) if version is None else ArdupilotProfile(vehicle_type, version)
