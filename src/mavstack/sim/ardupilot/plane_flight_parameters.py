"""Flight parameters of ArduPlane; those of a quadplane are a copter's while its lifting motors carry it."""

from __future__ import annotations

from math import inf, radians
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

from mavstack.sim.ardupilot.base_flight_parameters import (
    CENTIDEGREE,
    CM,
    MIN_RADIUS,
    MIN_SPEED,
    ArdupilotFlightParameters,
    Limits,
)

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle


class PlaneFlightParameters(ArdupilotFlightParameters):
    """ArduPlane, and a quadplane in forward flight."""

    follows_positions = False
    limits: ClassVar[Limits] = MappingProxyType(
        {
            "AIRSPEED_CRUISE": ("speed", 1.0),
            "AIRSPEED_MIN": ("airspeed_min", 1.0),
            "AIRSPEED_MAX": ("airspeed_max", 1.0),
            "TECS_CLMB_MAX": ("climb", 1.0),
            "TECS_SINK_MAX": ("sink", 1.0),
            "ROLL_LIMIT_DEG": ("tilt", radians(1.0)),
            "WP_LOITER_RAD": ("loiter_radius", 1.0),
        }
    )

    @property
    def takeoff_altitude(self) -> float:
        return self.number("TKOFF_ALT", minimum=5.0)

    @property
    def cruise_speed(self) -> float:
        return self.number("AIRSPEED_CRUISE", minimum=5.0)

    @property
    def climb_speed(self) -> float:
        return self.number("TECS_CLMB_MAX", minimum=MIN_SPEED)

    @property
    def sink_speed(self) -> float:
        return self.number("TECS_SINK_MAX", minimum=MIN_SPEED)

    @property
    def land_speed(self) -> float:
        return self.number("TECS_LAND_SINK", minimum=MIN_SPEED)

    @property
    def acceptance_radius(self) -> float:
        return self.number("WP_RADIUS", minimum=1.0)

    @property
    def loiter_radius(self) -> float:
        return self.number("WP_LOITER_RAD") or 60.0

    @property
    def return_altitude(self) -> float:
        """Metres above home; -inf to keep the present altitude."""
        altitude = self.number("RTL_ALTITUDE")
        return altitude if altitude >= 0 else -inf

    @property
    def land_disarm_delay(self) -> float:
        return self.number("LAND_DISARMDELAY") or inf

    @property
    def lean_angle(self) -> float:
        return self.number("ROLL_LIMIT_DEG", radians(1.0), minimum=0.1, default=radians(45.0))

    @property
    def pilot_climb_speed(self) -> float:
        return self.number("FBWB_CLIMB_RATE", minimum=MIN_SPEED, default=2.0)

    @property
    def acro_rate(self) -> float:
        return self.number("ACRO_ROLL_RATE", radians(1.0), minimum=0.1, default=radians(180.0))

    @property
    def circle_radius(self) -> float:
        return self.loiter_radius

    @property
    def circle_speed(self) -> float:
        return self.cruise_speed

    @property
    def flare_altitude(self) -> float:
        return self.number("LAND_FLARE_ALT", minimum=0.5, default=3.0)

    @property
    def thrust_is_climb(self) -> bool:
        return False


class QuadplaneFlightParameters(PlaneFlightParameters):
    """A quadplane: like a plane on its wing, like a copter in hover."""

    limits: ClassVar[Limits] = PlaneFlightParameters.limits

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        super().__init__(vehicle.parameters)
        self._vehicle = vehicle

    @property
    def _hovers(self) -> bool:
        return not self._vehicle.body.flies_forward

    @property
    def _returns_in_hover(self) -> bool:
        return self._vehicle.autopilot.mode.name == "QRTL"

    @property
    def return_altitude(self) -> float:
        return self.number("Q_RTL_ALT", minimum=5.0) if self._returns_in_hover else super().return_altitude

    @property
    def return_loiter_time(self) -> float:
        return 0.0 if self._returns_in_hover else inf

    @property
    def land_disarm_delay(self) -> float:
        return 1.0

    @property
    def land_slow_altitude(self) -> float:
        return self.number("Q_LAND_FINAL_ALT", minimum=1.0, default=6.0)

    @property
    def lean_angle(self) -> float:
        return self.number("Q_ANGLE_MAX", CENTIDEGREE, minimum=0.1) if self._hovers else super().lean_angle

    @property
    def pilot_climb_speed(self) -> float:
        if self._hovers:
            return self.number("Q_PILOT_SPD_UP", minimum=MIN_SPEED, default=2.5)
        return super().pilot_climb_speed

    @property
    def pilot_yaw_rate(self) -> float:
        return self.number("Q_PLT_Y_RATE", radians(1.0), minimum=0.1, default=radians(100.0))

    @property
    def takeoff_altitude(self) -> float:
        return self.number("Q_RTL_ALT", minimum=5.0)

    @property
    def cruise_speed(self) -> float:
        return self.number("Q_WP_SPEED", CM, minimum=MIN_SPEED) if self._hovers else super().cruise_speed

    @property
    def climb_speed(self) -> float:
        return self.number("Q_WP_SPEED_UP", CM, minimum=MIN_SPEED) if self._hovers else super().climb_speed

    @property
    def sink_speed(self) -> float:
        return self.number("Q_WP_SPEED_DN", CM, minimum=MIN_SPEED) if self._hovers else super().sink_speed

    @property
    def land_speed(self) -> float:
        return self.number("Q_LAND_FINAL_SPD", minimum=MIN_SPEED)

    @property
    def acceptance_radius(self) -> float:
        if self._hovers:
            return self.number("Q_WP_RADIUS", CM, minimum=MIN_RADIUS)
        return super().acceptance_radius
