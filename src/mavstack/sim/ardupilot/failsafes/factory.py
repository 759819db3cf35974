"""Creation of a vehicle's failsafes, by vehicle type."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.sim.ardupilot.failsafes.battery import BatteryFailsafes
from mavstack.sim.ardupilot.failsafes.copter import CopterFailsafes
from mavstack.sim.ardupilot.failsafes.crash import CrashCheck
from mavstack.sim.ardupilot.failsafes.estimator import EstimatorCheck
from mavstack.sim.ardupilot.failsafes.plane import PlaneFailsafes
from mavstack.sim.ardupilot.failsafes.rover import RoverFailsafes
from mavstack.sim.ardupilot.failsafes.sub import SubFailsafes
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.sim.ardupilot.failsafes.firmware import FirmwareFailsafes, ModeFailure
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

_ESTIMATE_CHECKED: Final = frozenset(
    {VehicleType.COPTER, VehicleType.VTOL, VehicleType.ROVER, VehicleType.BOAT}
)


class ArdupilotFailsafes:
    """Registers the failsafes of an autopilot; `mode_failure` returns why a mode cannot be entered."""

    def __init__(self, autopilot: SimulatedAutopilot, mode_failure: ModeFailure) -> None:
        vehicle_type = autopilot.vehicle.vehicle_type
        self.firmware = _firmware_of(vehicle_type)(autopilot, mode_failure)
        self.battery = BatteryFailsafes(self.firmware)
        self.estimator = EstimatorCheck(self.firmware) if vehicle_type in _ESTIMATE_CHECKED else None
        self.crash = CrashCheck(self.firmware) if vehicle_type is VehicleType.COPTER else None


def _firmware_of(vehicle_type: VehicleType) -> type[FirmwareFailsafes]:
    """Return the failsafes class of a vehicle type."""
    if vehicle_type is VehicleType.COPTER:
        return CopterFailsafes
    if vehicle_type in (VehicleType.PLANE, VehicleType.VTOL):
        return PlaneFailsafes
    return SubFailsafes if vehicle_type is VehicleType.SUB else RoverFailsafes
