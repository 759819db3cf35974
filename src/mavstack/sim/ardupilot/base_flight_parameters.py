"""Base of ArduPilot's flight parameters, and the limits of the body that follow from parameters.

Copter and Sub use centimetres, Plane and Rover metres. An invalid value (zero or NaN) is replaced by the
minimum that can be flown. `apply_limits` sets the limits of the body at boot and whenever one of their
parameters changes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf, isfinite, radians
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, TypeAlias

from mavstack.dialects import common
from mavstack.sim.autopilot.flight_parameters import FlightParameters

if TYPE_CHECKING:
    from mavstack.sim.motion import Body
    from mavstack.sim.parameters import Parameters

CM = 0.01
CENTIDEGREE = radians(0.01)
MIN_SPEED = 0.1
MIN_RADIUS = 0.5
#: Bit of CIRCLE_OPTIONS.
_CENTRE_AT_VEHICLE = 4
_F = common.MavFrame
_FRAMES = frozenset({int(_F.LOCAL_NED), int(_F.LOCAL_OFFSET_NED), int(_F.BODY_NED), int(_F.BODY_OFFSET_NED)})

#: Limit of the body that a parameter sets, and the parameter's unit.
Limits: TypeAlias = Mapping[str, tuple[str, float]]


class ArdupilotFlightParameters(FlightParameters):
    """Flight parameters of all types."""

    #: Limits of the body by parameter.
    limits: ClassVar[Limits] = MappingProxyType({})

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters

    def number(self, name: str, unit: float = 1.0, *, minimum: float = -inf, default: float = 0.0) -> float:
        """Return a parameter in metres, seconds or radians."""
        value = float(self._parameters.get(name, default / unit)) * unit
        return max(value, minimum) if isfinite(value) else max(default, minimum)

    def apply_limits(self, body: Body) -> None:
        """Set the limits of the body, and again whenever their parameters change."""
        for name, (limit, unit) in self.limits.items():
            if name in self._parameters:
                set_limit = _limit_setter(self, body, name, limit, unit)
                set_limit(None)
                self._parameters.on_change(name, set_limit)

    @property
    def loiter_radius(self) -> float:
        return 10.0

    @property
    def takeoff_altitude(self) -> float:
        return 10.0

    @property
    def land_speed(self) -> float:
        return self.sink_speed

    @property
    def acceptance_radius(self) -> float:
        return 2.0

    @property
    def lean_angle(self) -> float:
        return self.number("ANGLE_MAX", CENTIDEGREE, minimum=0.1, default=radians(30.0))

    @property
    def pilot_climb_speed(self) -> float:
        return self.number("PILOT_SPEED_UP", CM, minimum=MIN_SPEED, default=2.5)

    @property
    def pilot_yaw_rate(self) -> float:
        return self.number("PILOT_Y_RATE", radians(1.0), minimum=0.1, default=radians(100.0))

    @property
    def acro_rate(self) -> float:
        return self.number("ACRO_RP_RATE", radians(1.0), minimum=0.1, default=radians(180.0))

    @property
    def circle_radius(self) -> float:
        """Radius of Circle mode in metres; negative (counter-clockwise) if CIRCLE_RATE is negative."""
        radius = self.number("CIRCLE_RADIUS", CM, default=10.0)
        return -radius if self.number("CIRCLE_RATE", default=20.0) < 0 else radius

    @property
    def circles_where_it_is(self) -> bool:
        return bool(int(self.number("CIRCLE_OPTIONS", default=0.0)) & _CENTRE_AT_VEHICLE)

    @property
    def circle_speed(self) -> float:
        turning = abs(self.number("CIRCLE_RATE", radians(1.0), default=radians(20.0)))
        speed = turning * abs(self.circle_radius)
        return min(max(speed, 0.2), self.cruise_speed)

    @property
    def setpoint_timeout(self) -> float:
        return 3.0

    @property
    def return_loiter_time(self) -> float:
        return inf

    @property
    def return_descend_altitude(self) -> float:
        return inf

    @property
    def return_cone_slope(self) -> float:
        return 0.0

    @property
    def disarm_delay(self) -> float:
        return inf

    @property
    def land_disarm_delay(self) -> float:
        return inf

    @property
    def land_slow_altitude(self) -> float:
        return 10.0

    @property
    def glide_slope(self) -> float:
        return 0.12

    @property
    def flare_altitude(self) -> float:
        return 3.0

    @property
    def forward_beyond(self) -> float:
        return inf

    @property
    def thrust_is_climb(self) -> bool:
        return True

    @property
    def setpoint_frames(self) -> frozenset[int]:
        return _FRAMES


def _limit_setter(
    flight_parameters: ArdupilotFlightParameters, body: Body, name: str, limit: str, unit: float
) -> Callable[[object], None]:
    """Return the callback that sets a limit from a parameter."""

    def set_limit(value: object) -> None:
        number = flight_parameters.number(name, unit)
        if number:
            body.set_limit(limit, abs(number))

    return set_limit
