"""ArduPilot's flight parameters by vehicle type, each from the parameters of its firmware.

Copter and Sub use centimetres, Plane and Rover metres.
"""

from __future__ import annotations

from math import inf, radians
from operator import attrgetter
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

from mavstack.dialects import common
from mavstack.sim.autopilot.flight_parameters import FlightParameters, Limits, computed, from_parameter
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle

_CM, _MILLISECOND = 0.01, 0.001
_DEGREE, _CENTIDEGREE = radians(1.0), radians(0.01)
_MIN_SPEED, _MIN_RADIUS = 0.1, 0.5
#: Bit of CIRCLE_OPTIONS that places the centre of the circle at the vehicle.
_CENTRE_AT_VEHICLE = 4
#: Bit of GUID_OPTIONS that makes the thrust of an attitude setpoint a thrust instead of a climb rate.
_THRUST_AS_THRUST = 1 << 3
_F = common.MavFrame


class ArdupilotFlightParameters(FlightParameters):
    """Flight parameters of all types."""

    takeoff_altitude = 10.0
    land_speed = computed(attrgetter("sink_speed"))
    land_slow_altitude = 10.0
    acceptance_radius = 2.0
    loiter_radius = 10.0
    glide_slope = 0.12
    flare_altitude = 3.0
    disarm_delay = land_disarm_delay = inf
    return_loiter_time = return_descend_altitude = inf
    return_cone_slope = 0.0
    lean_angle = from_parameter("ANGLE_MAX", _CENTIDEGREE, minimum=0.1, default=radians(30.0))
    pilot_climb_speed = from_parameter("PILOT_SPEED_UP", _CM, minimum=_MIN_SPEED, default=2.5)
    pilot_yaw_rate = from_parameter("PILOT_Y_RATE", _DEGREE, minimum=0.1, default=radians(100.0))
    acro_rate = from_parameter("ACRO_RP_RATE", _DEGREE, minimum=0.1, default=radians(180.0))
    setpoint_timeout = 3.0
    setpoint_frames = frozenset({_F.LOCAL_NED, _F.LOCAL_OFFSET_NED, _F.BODY_NED, _F.BODY_OFFSET_NED})
    thrust_is_climb = True
    forward_beyond = inf

    @computed
    def circle_radius(self) -> float:
        """Radius of Circle mode in metres; negative (counter-clockwise) if CIRCLE_RATE is negative."""
        radius = self.number("CIRCLE_RADIUS", _CM, default=10.0)
        return -radius if self.number("CIRCLE_RATE", default=20.0) < 0 else radius

    @computed
    def circles_where_it_is(self) -> bool:
        return bool(int(self.number("CIRCLE_OPTIONS", default=0.0)) & _CENTRE_AT_VEHICLE)

    @computed
    def circle_speed(self) -> float:
        turning = abs(self.number("CIRCLE_RATE", _DEGREE, default=radians(20.0)))
        speed = turning * abs(self.circle_radius)
        return min(max(speed, 0.2), self.cruise_speed)

    def limit_of(self, number: float) -> float:
        return abs(number)


class CopterFlightParameters(ArdupilotFlightParameters):
    """ArduCopter."""

    limits: ClassVar[Limits] = MappingProxyType(
        {
            "WPNAV_ACCEL": ("acceleration", _CM),
            "ANGLE_MAX": ("tilt", _CENTIDEGREE),
            "LOIT_SPEED": ("speed", _CM),
        }
    )
    takeoff_altitude = from_parameter("PILOT_TKOFF_ALT", _CM, zero_means=10.0)
    cruise_speed = from_parameter("WPNAV_SPEED", _CM, minimum=_MIN_SPEED)
    climb_speed = from_parameter("WPNAV_SPEED_UP", _CM, minimum=_MIN_SPEED)
    sink_speed = from_parameter("WPNAV_SPEED_DN", _CM, minimum=_MIN_SPEED)
    land_speed = from_parameter("LAND_SPEED", _CM, minimum=_MIN_SPEED)
    land_slow_altitude = from_parameter("LAND_ALT_LOW", _CM, minimum=1.0, default=10.0)
    #: Seconds: copters disarm soon after an automatic landing.
    land_disarm_delay = 1.0
    disarm_delay = from_parameter("DISARM_DELAY", zero_means=inf)
    acceptance_radius = from_parameter("WPNAV_RADIUS", _CM, minimum=_MIN_RADIUS)
    loiter_radius = from_parameter("CIRCLE_RADIUS", _CM)
    return_altitude = from_parameter("RTL_ALT", _CM, minimum=0.0)
    return_descend_altitude = from_parameter("RTL_ALT_FINAL", _CM, zero_means=inf)
    return_cone_slope = from_parameter("RTL_CONE_SLOPE", minimum=0.0, default=3.0)
    setpoint_timeout = from_parameter("GUID_TIMEOUT", minimum=0.1, default=3.0)

    @computed
    def return_loiter_time(self) -> float:
        """Seconds over home; infinite with a final altitude, at which the copter stays."""
        if self.number("RTL_ALT_FINAL", _CM) > 0:
            return inf
        return self.number("RTL_LOIT_TIME", _MILLISECOND, minimum=0.0)

    @computed
    def thrust_is_climb(self) -> bool:
        """True unless GUID_OPTIONS selects thrust."""
        return not int(self.number("GUID_OPTIONS")) & _THRUST_AS_THRUST


class PlaneFlightParameters(ArdupilotFlightParameters):
    """ArduPlane, and a quadplane in forward flight."""

    limits: ClassVar[Limits] = MappingProxyType(
        {
            "AIRSPEED_CRUISE": ("speed", 1.0),
            "AIRSPEED_MIN": ("airspeed_min", 1.0),
            "AIRSPEED_MAX": ("airspeed_max", 1.0),
            "TECS_CLMB_MAX": ("climb", 1.0),
            "TECS_SINK_MAX": ("sink", 1.0),
            "ROLL_LIMIT_DEG": ("tilt", _DEGREE),
            "WP_LOITER_RAD": ("loiter_radius", 1.0),
        }
    )
    takeoff_altitude = from_parameter("TKOFF_ALT", minimum=5.0)
    cruise_speed = from_parameter("AIRSPEED_CRUISE", minimum=5.0)
    climb_speed = from_parameter("TECS_CLMB_MAX", minimum=_MIN_SPEED)
    sink_speed = from_parameter("TECS_SINK_MAX", minimum=_MIN_SPEED)
    land_speed = from_parameter("TECS_LAND_SINK", minimum=_MIN_SPEED)
    land_disarm_delay = from_parameter("LAND_DISARMDELAY", zero_means=inf)
    flare_altitude = from_parameter("LAND_FLARE_ALT", minimum=0.5, default=3.0)
    acceptance_radius = from_parameter("WP_RADIUS", minimum=1.0)
    loiter_radius = from_parameter("WP_LOITER_RAD", zero_means=60.0)
    circle_radius = computed(attrgetter("loiter_radius"))
    circle_speed = computed(attrgetter("cruise_speed"))
    lean_angle = from_parameter("ROLL_LIMIT_DEG", _DEGREE, minimum=0.1, default=radians(45.0))
    pilot_climb_speed = from_parameter("FBWB_CLIMB_RATE", minimum=_MIN_SPEED, default=2.0)
    acro_rate = from_parameter("ACRO_ROLL_RATE", _DEGREE, minimum=0.1, default=radians(180.0))
    follows_positions = False
    thrust_is_climb = False

    @computed
    def return_altitude(self) -> float:
        """Metres above home; -inf to keep the present altitude."""
        altitude = self.number("RTL_ALTITUDE")
        return altitude if altitude >= 0 else -inf


class _HoverFlightParameters(PlaneFlightParameters):
    """A quadplane while its lifting motors carry it."""

    cruise_speed = from_parameter("Q_WP_SPEED", _CM, minimum=_MIN_SPEED)
    climb_speed = from_parameter("Q_WP_SPEED_UP", _CM, minimum=_MIN_SPEED)
    sink_speed = from_parameter("Q_WP_SPEED_DN", _CM, minimum=_MIN_SPEED)
    acceptance_radius = from_parameter("Q_WP_RADIUS", _CM, minimum=_MIN_RADIUS)
    lean_angle = from_parameter("Q_ANGLE_MAX", _CENTIDEGREE, minimum=0.1)
    pilot_climb_speed = from_parameter("Q_PILOT_SPD_UP", minimum=_MIN_SPEED, default=2.5)


class QuadplaneFlightParameters(PlaneFlightParameters):
    """A quadplane: like a plane on its wing, like a copter in hover."""

    takeoff_altitude = from_parameter("Q_RTL_ALT", minimum=5.0)
    cruise_speed = computed(attrgetter("_active.cruise_speed"))
    climb_speed = computed(attrgetter("_active.climb_speed"))
    sink_speed = computed(attrgetter("_active.sink_speed"))
    acceptance_radius = computed(attrgetter("_active.acceptance_radius"))
    lean_angle = computed(attrgetter("_active.lean_angle"))
    pilot_climb_speed = computed(attrgetter("_active.pilot_climb_speed"))
    pilot_yaw_rate = from_parameter("Q_PLT_Y_RATE", _DEGREE, minimum=0.1, default=radians(100.0))
    land_speed = from_parameter("Q_LAND_FINAL_SPD", minimum=_MIN_SPEED)
    land_slow_altitude = from_parameter("Q_LAND_FINAL_ALT", minimum=1.0, default=6.0)
    land_disarm_delay = 1.0

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        super().__init__(vehicle.parameters)
        self._vehicle = vehicle
        self._hover = _HoverFlightParameters(vehicle.parameters)
        self._wing = PlaneFlightParameters(vehicle.parameters)

    @property
    def _active(self) -> PlaneFlightParameters:
        return self._wing if self._vehicle.body.flies_forward else self._hover

    @property
    def _returns_in_hover(self) -> bool:
        return self._vehicle.autopilot.mode.name == "QRTL"

    @computed
    def return_altitude(self) -> float:
        if self._returns_in_hover:
            return self.number("Q_RTL_ALT", minimum=5.0)
        return self._wing.return_altitude

    @computed
    def return_loiter_time(self) -> float:
        return 0.0 if self._returns_in_hover else inf


class RoverFlightParameters(ArdupilotFlightParameters):
    """Rovers and boats."""

    limits: ClassVar[Limits] = MappingProxyType(
        {"WP_SPEED": ("speed", 1.0), "ATC_ACCEL_MAX": ("acceleration", 1.0)}
    )
    takeoff_altitude = return_altitude = 0.0
    climb_speed = sink_speed = 0.5
    acceptance_radius = from_parameter("WP_RADIUS", minimum=_MIN_RADIUS)
    loiter_radius = computed(attrgetter("circle_radius"))
    pilot_yaw_rate = from_parameter("ACRO_TURN_RATE", _DEGREE, minimum=0.1, default=radians(180.0))
    thrust_is_climb = False

    @computed
    def cruise_speed(self) -> float:
        return self.number("WP_SPEED") or self.number("CRUISE_SPEED", minimum=_MIN_SPEED)

    @computed
    def circle_radius(self) -> float:
        radius = self.number("CIRC_RADIUS", default=20.0) or 20.0
        return -radius if int(self.number("CIRC_DIR")) == 1 else radius

    @computed
    def circle_speed(self) -> float:
        return self.number("CIRC_SPEED") or self.cruise_speed


class SubFlightParameters(ArdupilotFlightParameters):
    """ArduSub: depths are negative altitudes."""

    limits: ClassVar[Limits] = MappingProxyType(
        {"WPNAV_ACCEL": ("acceleration", _CM), "LOIT_SPEED": ("speed", _CM)}
    )
    takeoff_altitude = 0.0
    cruise_speed = from_parameter("WPNAV_SPEED", _CM, minimum=_MIN_SPEED)
    climb_speed = from_parameter("WPNAV_SPEED_UP", _CM, minimum=_MIN_SPEED)
    sink_speed = from_parameter("WPNAV_SPEED_DN", _CM, minimum=_MIN_SPEED)
    acceptance_radius = from_parameter("WPNAV_RADIUS", _CM, minimum=_MIN_RADIUS)
    loiter_radius = from_parameter("CIRCLE_RADIUS", _CM)

    @computed
    def return_altitude(self) -> float:
        """Surface depth as a negative altitude in metres."""
        return min(self.number("SURFACE_DEPTH", _CM, default=-0.1), 0.0)


def flight_parameters_of(vehicle: SimulatedVehicle) -> ArdupilotFlightParameters:
    """Return the flight parameters of a vehicle."""
    parameters = vehicle.parameters
    match vehicle.vehicle_type:
        case VehicleType.COPTER:
            return CopterFlightParameters(parameters)
        case VehicleType.PLANE:
            return PlaneFlightParameters(parameters)
        case VehicleType.VTOL:
            return QuadplaneFlightParameters(vehicle)
        case VehicleType.SUB:
            return SubFlightParameters(parameters)
    return RoverFlightParameters(parameters)
