"""The vehicle as message producers see it, with shared values computed once per step.

A view belongs to one boot of the vehicle. Readings and global positions are cached for the step in which they
were computed, the position of home until home changes, and the result of the arming checks for a second.
"""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING, NamedTuple

from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.sim.motion import Body, EstimateHealth, SensorReadings
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.sim.vehicle_types import Home

#: Seconds for which the result of the arming checks is cached.
_PREARM_INTERVAL = 1.0
_NEVER = float("-inf")
_WINGED = (VehicleType.PLANE, VehicleType.VTOL)


class GlobalPosition(NamedTuple):
    """Latitude and longitude in degrees, altitude in metres above mean sea level."""

    latitude: float
    longitude: float
    altitude: float


class VehicleView:
    """One vehicle as telemetry sees it."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self.vehicle = vehicle
        self.autopilot = vehicle.autopilot
        self.body: Body = vehicle.body
        self.parameters = vehicle.parameters
        self.booted_at = vehicle.booted_at
        self.winged = vehicle.vehicle_type in _WINGED
        self._position_at = self._truth_at = self._sensors_at = self._health_at = self._ready_at = _NEVER
        self._sensors: SensorReadings
        self._health: EstimateHealth
        self._position = self._truth = GlobalPosition(nan, nan, nan)
        self._home: Home | None = None
        self._home_position = (0.0, 0.0, 0.0)
        self._ready = False
        self._was_positioned = False

    def milliseconds(self, now: float) -> int:
        """Return the milliseconds since boot, as `time_boot_ms`."""
        return round((now - self.booted_at) * 1e3) & 0xFFFFFFFF

    def microseconds(self, now: float) -> int:
        """Return the microseconds since boot, as `time_usec`."""
        return round((now - self.booted_at) * 1e6)

    @property
    def position(self) -> GlobalPosition:
        """Estimated global position in degrees and metres."""
        now = self.vehicle.now
        if now != self._position_at:
            here = self.body.estimate
            self._position = GlobalPosition(*self.body.frame.to_global(here.north, here.east, here.down))
            self._position_at = now
        return self._position

    @property
    def true_position(self) -> GlobalPosition:
        """True global position in degrees and metres."""
        now = self.vehicle.now
        if now != self._truth_at:
            here = self.body.truth
            self._truth = GlobalPosition(*self.body.frame.to_global(here.north, here.east, here.down))
            self._truth_at = now
        return self._truth

    @property
    def sensors(self) -> SensorReadings:
        """Sensor readings of this step."""
        now = self.vehicle.now
        if now != self._sensors_at:
            self._sensors, self._sensors_at = self.body.sensors, now
        return self._sensors

    @property
    def health(self) -> EstimateHealth:
        """Health of the estimate."""
        now = self.vehicle.now
        if now != self._health_at:
            self._health, self._health_at = self.body.health, now
        return self._health

    @property
    def has_position(self) -> bool:
        """True while the estimate has a valid position in the local frame."""
        return self.autopilot.booted and self.health.horizontal

    @property
    def has_global_position(self) -> bool:
        """True while the estimate has a valid position on Earth."""
        return self.autopilot.has_position

    @property
    def was_positioned(self) -> bool:
        """True if the estimate has had a valid position on Earth since boot."""
        if not self._was_positioned:
            self._was_positioned = self.has_global_position
        return self._was_positioned

    @property
    def home(self) -> tuple[float, float, float]:
        """Home in local metres (north, east, down); the start if home is not set."""
        home = self.autopilot.home
        if home is not self._home:
            self._home, self._home_position = home, self.autopilot.home_position
        return self._home_position

    @property
    def altitude(self) -> float:
        """Estimated altitude above home in metres."""
        return self.home[2] - self.body.estimate.down

    @property
    def reported_height(self) -> float:
        """The altitude above home in metres as the firmware reports it."""
        return self.position.altitude if self.vehicle.profile.reports_no_height else self.altitude

    @property
    def ready(self) -> bool:
        """True if the vehicle is armed or the firmware's arming checks pass."""
        if self.autopilot.armed:
            return True
        now = self.vehicle.now
        if not 0 <= now - self._ready_at < _PREARM_INTERVAL:
            self._ready_at = now
            problems = self.autopilot.profile.prearm_problems(self.autopilot)
            self._ready = next(iter(problems), None) is None
        return self._ready

    def parameter(self, name: str, default: float) -> float:
        """Return a parameter as a number, or `default` if the vehicle does not have it."""
        return float(self.parameters.get(name, default))
