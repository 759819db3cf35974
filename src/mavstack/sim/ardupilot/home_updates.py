"""Home of a disarmed ArduPilot: it follows the vehicle until the vehicle arms, or home was set by command.

| type | home is set again |
|---|---|
| plane, VTOL | every 5 s while the receiver has a 3D fix |
| rover, boat | checked every second, when the vehicle moved by more than half a metre |
| copter, sub | only when the vehicle arms |

Each time HOME_POSITION is broadcast, which is how a ground station that connects late learns home.
"""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

#: By vehicle type: seconds between two checks, and the distance in metres that the vehicle must have moved.
_RULES: Final = {
    VehicleType.PLANE: (5.0, 0.0),
    VehicleType.VTOL: (5.0, 0.0),
    VehicleType.ROVER: (1.0, 0.5),
    VehicleType.BOAT: (1.0, 0.5),
}


class HomeUpdates:
    """Sets home again while the vehicle is disarmed."""

    def __init__(self, autopilot: SimulatedAutopilot, interval: float, min_distance: float) -> None:
        self._autopilot = autopilot
        self._interval, self._min_distance = interval, min_distance
        self._due = autopilot.now + interval

    def tick(self, now: float) -> None:
        """Set home to the current position when it is due."""
        if now < self._due:
            return
        self._due = now + self._interval
        autopilot = self._autopilot
        if autopilot.home is None or autopilot.home_locked or autopilot.armed or not self._has_fix():
            return
        north, east, _ = autopilot.home_position
        here = autopilot.body.estimate
        if hypot(here.north - north, here.east - east) >= self._min_distance:
            autopilot.set_home_here()

    def _has_fix(self) -> bool:
        autopilot = self._autopilot
        return autopilot.has_position and autopilot.body.sensors.gps_fix >= common.GpsFixType["_3D_FIX"]


def watch_home(autopilot: SimulatedAutopilot, vehicle_type: VehicleType) -> None:
    """Let home follow a disarmed vehicle, if its type does that.

    Args:
        autopilot: The autopilot.
        vehicle_type: The type of its vehicle.
    """
    if (rule := _RULES.get(vehicle_type)) is not None:
        autopilot.watches.append(HomeUpdates(autopilot, *rule))
