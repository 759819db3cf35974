"""What the producers of messages look at: one vehicle, with what several of them need computed once a step.

A view belongs to one boot of the vehicle. Readings and places on Earth are kept for the step they were
computed in, the place of home until there is another home, and what the arming checks say for a second.
"""

from __future__ import annotations

from math import cos, nan, sin
from typing import TYPE_CHECKING, NamedTuple

from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import Vehicle
    from mavstack.sim.motion import Body, EstimateHealth, SensorReadings
    from mavstack.sim.vehicle_types import Home

#: For so long the answer of the arming checks is believed.
_CHECKED_FOR = 1.0
_NEVER = float("-inf")
_WINGED = (VehicleType.PLANE, VehicleType.VTOL)


class Place(NamedTuple):
    """Degrees, and metres above mean sea level."""

    latitude: float
    longitude: float
    altitude: float


class View:
    """One vehicle as telemetry sees it."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.autopilot = vehicle.autopilot
        self.body: Body = vehicle.body
        self.parameters = vehicle.parameters
        self.booted_at = vehicle.booted_at
        self.winged = vehicle.type in _WINGED
        self._place_at = self._truth_at = self._sensors_at = self._health_at = self._ready_at = _NEVER
        self._sensors: SensorReadings
        self._health: EstimateHealth
        self._place = self._truth = Place(nan, nan, nan)
        self._home: Home | None = None
        self._home_position = (0.0, 0.0, 0.0)
        self._ready = False
        self._was_positioned = False

    def milliseconds(self, now: float) -> int:
        """Since boot, as `time_boot_ms`."""
        return round((now - self.booted_at) * 1e3) & 0xFFFFFFFF

    def microseconds(self, now: float) -> int:
        """Since boot, as `time_usec`."""
        return round((now - self.booted_at) * 1e6)

    @property
    def place(self) -> Place:
        """Where the vehicle believes to be."""
        now = self.vehicle.now
        if now != self._place_at:
            here = self.body.estimate
            self._place = Place(*self.body.frame.to_global(here.north, here.east, here.down))
            self._place_at = now
        return self._place

    @property
    def true_place(self) -> Place:
        """Where the vehicle is."""
        now = self.vehicle.now
        if now != self._truth_at:
            here = self.body.truth
            self._truth = Place(*self.body.frame.to_global(here.north, here.east, here.down))
            self._truth_at = now
        return self._truth

    @property
    def sensors(self) -> SensorReadings:
        """What the sensors read."""
        now = self.vehicle.now
        if now != self._sensors_at:
            self._sensors, self._sensors_at = self.body.sensors, now
        return self._sensors

    @property
    def health(self) -> EstimateHealth:
        """How good the estimate is."""
        now = self.vehicle.now
        if now != self._health_at:
            self._health, self._health_at = self.body.health, now
        return self._health

    @property
    def has_position(self) -> bool:
        """Whether the estimate knows now where it is."""
        return self.autopilot.booted and self.health.horizontal

    @property
    def was_positioned(self) -> bool:
        """Whether the estimate ever knew since boot where it is: from then on it has a position to tell."""
        if not self._was_positioned:
            self._was_positioned = self.has_position
        return self._was_positioned

    @property
    def home(self) -> tuple[float, float, float]:
        """Home in local metres; where the vehicle began if there is none yet."""
        home = self.autopilot.home
        if home is not self._home:
            self._home, self._home_position = home, self.autopilot.home_position
        return self._home_position

    @property
    def altitude(self) -> float:
        """Above home, as the vehicle believes."""
        return self.home[2] - self.body.estimate.down

    @property
    def ready(self) -> bool:
        """Whether the firmware's checks find nothing wrong, or it is armed."""
        if self.autopilot.armed:
            return True
        now = self.vehicle.now
        if not 0 <= now - self._ready_at < _CHECKED_FOR:
            self._ready_at = now
            problems = self.autopilot.profile.prearm_problems(self.autopilot)
            self._ready = next(iter(problems), None) is None
        return self._ready

    def parameter(self, name: str, default: float) -> float:
        """A parameter as a number, or `default` if this vehicle does not have it."""
        return float(self.parameters.get(name, default))


def quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """An attitude as w, x, y, z."""
    sr, cr = sin(roll * 0.5), cos(roll * 0.5)
    sp, cp = sin(pitch * 0.5), cos(pitch * 0.5)
    sy, cy = sin(yaw * 0.5), cos(yaw * 0.5)
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )
