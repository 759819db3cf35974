"""Which profile a firmware has on a type of vehicle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.ardupilot import ArdupilotProfile
from mavstack.sim.px4 import Px4Profile
from mavstack.sim.vehicle_types import Firmware

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import FirmwareProfile
    from mavstack.sim.vehicle_types import VehicleType


def profile_of(firmware: Firmware, type: VehicleType) -> FirmwareProfile:  # noqa: A002 (HEARTBEAT's name for it)
    """The profile of one vehicle."""
    return Px4Profile(type) if firmware is Firmware.PX4 else ArdupilotProfile(type)
