"""Flight parameters: the speeds, altitudes and radii that behaviours use.

Each is computed from a parameter of the firmware, in metres, seconds and radians, at the moment of use, so
that a parameter that is set in flight takes effect immediately. An invalid value (zero or NaN) is replaced by
the minimum that can be flown.

    class RoverFlightParameters(FlightParameters):
        cruise_speed = from_parameter("WP_SPEED", minimum=0.1)
        takeoff_altitude = 0.0

        @computed
        def circle_radius(self) -> float:
            return self.cruise_speed * 10
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf, isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias, TypeVar, cast

if TYPE_CHECKING:
    from mavstack.sim.motion import Body
    from mavstack.sim.parameters import Parameters

#: By parameter: the limit of the body that the parameter sets, and the factor from its unit to SI units.
Limits: TypeAlias = Mapping[str, tuple[str, float]]
_Value = TypeVar("_Value")


def computed(function: Callable[[Any], _Value]) -> _Value:
    """Declare a flight parameter that a function of the flight parameters computes at each use.

    `computed(attrgetter("sink_speed"))` declares one that equals another one.
    """
    return cast("_Value", property(function))


def from_parameter(
    name: str, unit: float = 1.0, *, minimum: float = -inf, default: float = 0.0, zero_means: float = 0.0
) -> float:
    """Declare a flight parameter that `FlightParameters.number` reads from one parameter at each use."""
    return computed(
        lambda flight: float(flight.number(name, unit, minimum=minimum, default=default) or zero_means)
    )


class FlightParameters:
    """The flight parameters of one vehicle; each firmware computes them from its own parameters."""

    #: The limits of the body that parameters set.
    limits: ClassVar[Limits] = MappingProxyType({})

    #: Default altitude of a takeoff, in metres above the ground.
    takeoff_altitude: float
    #: Cruise speed in m/s: ground speed of a vehicle that can stop, airspeed of a wing.
    cruise_speed: float
    #: Climb rate, in m/s.
    climb_speed: float
    #: Descent rate, in m/s, positive.
    sink_speed: float
    #: Descent rate near the ground, in m/s, positive.
    land_speed: float
    #: Distance at which a point counts as reached, in metres.
    acceptance_radius: float
    #: Default radius of a circle, in metres; negative means counter-clockwise.
    loiter_radius: float
    #: Altitude of the return, in metres above home; -infinity keeps the current altitude.
    return_altitude: float
    #: Seconds of waiting above home before the landing; infinity never lands.
    return_loiter_time: float
    #: Seconds for which a velocity setpoint is flown if no other setpoint follows.
    setpoint_timeout: float
    #: Seconds from the landing to disarming; infinity never disarms.
    disarm_delay: float

    # Manual flight

    #: Maximum lean of a hovering vehicle or bank of a wing at full stick, in radians.
    lean_angle: float
    #: Climb and descent rate at full throttle stick, in m/s.
    pilot_climb_speed: float
    #: Maximum yaw rate of the stick, in rad/s.
    pilot_yaw_rate: float
    #: Maximum roll and pitch rate of the sticks in rate modes, in rad/s.
    acro_rate: float

    # Landing and return

    #: Height above the ground below which the vehicle descends at `land_speed`, in metres.
    land_slow_altitude: float
    #: Seconds from touchdown to disarming in landing modes; other modes use `disarm_delay`.
    land_disarm_delay: float
    #: Altitude at which the vehicle waits above home, in metres above home; infinity keeps the return
    #: altitude.
    return_descend_altitude: float
    #: Slope (altitude over distance) of the climb of a return near home; 0 always climbs to
    #: `return_altitude`.
    return_cone_slope: float
    #: Slope (height over distance) of a wing's final approach.
    glide_slope: float
    #: Height above the ground where a landing wing raises its nose, in metres.
    flare_altitude: float

    # Circles

    #: Radius of the circle or orbit mode, in metres; negative means counter-clockwise.
    circle_radius: float
    #: True if the centre of the circle mode is the current position, False if it is one radius ahead.
    circles_where_it_is: bool
    #: Speed along the circle in the circle mode, in m/s; wings fly at their cruise speed.
    circle_speed: float

    # Guided flight

    #: The frames that SET_POSITION_TARGET_LOCAL_NED may use; setpoints in other frames are ignored.
    setpoint_frames: frozenset[int]
    #: False if only the altitude of position setpoints is followed, as ArduPlane does.
    follows_positions = True
    #: True if the thrust of an attitude setpoint means a climb rate (0.5 holds the altitude).
    thrust_is_climb: bool
    #: Distance in metres beyond which a hovering VTOL changes to forward flight; infinity: never.
    forward_beyond: float

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
                set_limit = self._limit_setter(body, name, limit, unit)
                set_limit(None)
                self._parameters.on_change(name, set_limit)

    def _limit_setter(self, body: Body, name: str, limit: str, unit: float) -> Callable[[object], None]:
        """Return the callback that sets a limit from a parameter."""

        def set_limit(value: object) -> None:
            number = self.limit_of(self.number(name, unit))
            if number > 0:
                body.set_limit(limit, number)

        return set_limit

    def limit_of(self, number: float) -> float:
        """Return the limit that the value of a parameter means; 0 and below leave the limit as it is."""
        return number
