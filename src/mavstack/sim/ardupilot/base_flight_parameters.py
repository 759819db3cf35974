"""What ArduPilot's flight parameters have in common: how parameters become flight parameters, and limits of the body.

Copter and Sub count in centimetres, Plane and Rover in metres. What a parameter cannot mean (nothing, or no
number) is replaced by the least that can be flown. The limits of the body follow the parameters: `follow`
sets them at boot and whenever one changes.
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
SLOWEST = 0.1
SMALLEST_RADIUS = 0.5
#: In CIRCLE_OPTIONS.
_CENTRE_IS_HERE = 4
_F = common.MavFrame
_FRAMES = frozenset({int(_F.LOCAL_NED), int(_F.LOCAL_OFFSET_NED), int(_F.BODY_NED), int(_F.BODY_OFFSET_NED)})

#: Which limits of the body a parameter sets, and in which unit the parameter is.
Limits: TypeAlias = Mapping[str, tuple[str, float]]


class ArdupilotFlightParameters(FlightParameters):
    """What all types have in common."""

    #: Parameter to limit of the body.
    limits: ClassVar[Limits] = MappingProxyType({})

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters

    def number(self, name: str, unit: float = 1.0, *, least: float = -inf, default: float = 0.0) -> float:
        """A parameter in metres, seconds or radians."""
        value = float(self._parameters.get(name, default / unit)) * unit
        return max(value, least) if isfinite(value) else max(default, least)

    def follow(self, body: Body) -> None:
        """Set the limits of the body, and again whenever their parameters change."""
        for name, (limit, unit) in self.limits.items():
            if name in self._parameters:
                push = _pusher(self, body, name, limit, unit)
                push(None)
                self._parameters.on_change(name, push)

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
        return self.number("ANGLE_MAX", CENTIDEGREE, least=0.1, default=radians(30.0))

    @property
    def pilot_climb_speed(self) -> float:
        return self.number("PILOT_SPEED_UP", CM, least=SLOWEST, default=2.5)

    @property
    def pilot_yaw_rate(self) -> float:
        return self.number("PILOT_Y_RATE", radians(1.0), least=0.1, default=radians(100.0))

    @property
    def acro_rate(self) -> float:
        return self.number("ACRO_RP_RATE", radians(1.0), least=0.1, default=radians(180.0))

    @property
    def circle_radius(self) -> float:
        """Counter-clockwise if CIRCLE_RATE is negative."""
        radius = self.number("CIRCLE_RADIUS", CM, default=10.0)
        return -radius if self.number("CIRCLE_RATE", default=20.0) < 0 else radius

    @property
    def circles_where_it_is(self) -> bool:
        return bool(int(self.number("CIRCLE_OPTIONS", default=0.0)) & _CENTRE_IS_HERE)

    @property
    def circle_speed(self) -> float:
        turning = abs(self.number("CIRCLE_RATE", radians(1.0), default=radians(20.0)))
        wanted = turning * abs(self.circle_radius)
        return min(max(wanted, 0.2), self.cruise_speed)

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


def _pusher(
    flight_parameters: ArdupilotFlightParameters, body: Body, name: str, limit: str, unit: float
) -> Callable[[object], None]:
    def push(value: object) -> None:
        number = flight_parameters.number(name, unit)
        if number:
            body.set_limit(limit, abs(number))

    return push
