"""PX4's flight parameters: metres, seconds and degrees in the parameters, radians here."""

from __future__ import annotations

from math import inf, radians, tan
from operator import attrgetter
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.flight_parameters import FlightParameters, Limits, computed, from_parameter
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.sim.motion import Body
    from mavstack.sim.parameters import Parameters
    from mavstack.sim.vehicle import SimulatedVehicle

_F = common.MavFrame
_DEGREE: Final = radians(1.0)
_MIN_SPEED, _MIN_RADIUS = 0.1, 0.3
_MIN_CONE_ANGLE, _MAX_CONE_ANGLE = 0.5, 89.5
_MIN_TIMEOUT = 0.1


class Px4FlightParameters(FlightParameters):
    """Flight parameters of all types."""

    #: Seconds: the autopilot never disarms by these delays; the land detector does, because it knows whether
    #: the vehicle has flown.
    disarm_delay = land_disarm_delay = inf
    setpoint_frames = frozenset({_F.LOCAL_NED, _F.BODY_NED})
    thrust_is_climb = False
    forward_beyond = inf
    takeoff_altitude = return_altitude = 0.0
    return_descend_altitude = return_loiter_time = return_cone_slope = 0.0
    land_slow_altitude = flare_altitude = 0.0
    glide_slope = 0.1
    climb_speed = sink_speed = 0.5
    lean_angle = pilot_climb_speed = acro_rate = 0.5
    acceptance_radius = from_parameter("NAV_ACC_RAD", minimum=_MIN_RADIUS)
    loiter_radius = from_parameter("NAV_LOITER_RAD", default=80.0, zero_means=80.0)
    setpoint_timeout = from_parameter("COM_OF_LOSS_T", minimum=_MIN_TIMEOUT, default=1.0)
    land_speed = computed(attrgetter("sink_speed"))
    circle_radius = computed(attrgetter("loiter_radius"))
    circles_where_it_is = True
    circle_speed = computed(attrgetter("cruise_speed"))
    pilot_yaw_rate = radians(60.0)


class _AircraftFlightParameters(Px4FlightParameters):
    """Take-off and return of all flying types."""

    takeoff_altitude = from_parameter("MIS_TAKEOFF_ALT", minimum=0.5)
    return_altitude = from_parameter("RTL_RETURN_ALT", minimum=0.0)
    return_descend_altitude = from_parameter("RTL_DESCEND_ALT", minimum=0.0)

    @computed
    def return_loiter_time(self) -> float:
        delay = self.number("RTL_LAND_DELAY")
        return inf if delay < 0 else delay

    @computed
    def return_cone_slope(self) -> float:
        """Slope of the cone above home with half angle RTL_CONE_ANG; 0 always climbs."""
        angle = self.number("RTL_CONE_ANG")
        return 1 / tan(radians(min(max(angle, _MIN_CONE_ANGLE), _MAX_CONE_ANGLE))) if angle > 0 else 0.0


class MulticopterFlightParameters(_AircraftFlightParameters):
    """A multicopter, and a VTOL in hover."""

    limits: ClassVar[Limits] = MappingProxyType(
        {
            "MPC_ACC_HOR": ("acceleration", 1.0),
            "MPC_TILTMAX_AIR": ("tilt", _DEGREE),
            "MPC_XY_VEL_MAX": ("speed", 1.0),
        }
    )
    cruise_speed = from_parameter("MPC_XY_CRUISE", minimum=_MIN_SPEED)
    climb_speed = from_parameter("MPC_Z_V_AUTO_UP", minimum=_MIN_SPEED)
    sink_speed = from_parameter("MPC_Z_V_AUTO_DN", minimum=_MIN_SPEED)
    land_speed = from_parameter("MPC_LAND_SPEED", minimum=_MIN_SPEED)
    land_slow_altitude = from_parameter("MPC_LAND_ALT2", minimum=0.0)
    lean_angle = from_parameter("MPC_MAN_TILT_MAX", _DEGREE, minimum=0.05)
    pilot_climb_speed = from_parameter("MPC_Z_VEL_MAX_UP", minimum=_MIN_SPEED)
    pilot_yaw_rate = from_parameter("MPC_MAN_Y_MAX", _DEGREE, minimum=0.05)
    acro_rate = from_parameter("MC_ACRO_R_MAX", _DEGREE, minimum=0.05)
    circle_radius = 20.0

    @computed
    def circle_speed(self) -> float:
        return min(self.cruise_speed, 3.0)


class FixedWingFlightParameters(_AircraftFlightParameters):
    """A fixed wing, and a VTOL in forward flight."""

    limits: ClassVar[Limits] = MappingProxyType(
        {
            "FW_AIRSPD_TRIM": ("airspeed_cruise", 1.0),
            "FW_AIRSPD_MAX": ("airspeed_max", 1.0),
            "FW_AIRSPD_MIN": ("airspeed_min", 1.0),
            "FW_T_CLMB_MAX": ("climb", 1.0),
            "FW_T_SINK_MAX": ("sink", 1.0),
            "FW_R_LIM": ("tilt", _DEGREE),
            "NAV_LOITER_RAD": ("loiter_radius", 1.0),
        }
    )
    cruise_speed = from_parameter("FW_AIRSPD_TRIM", minimum=5.0)
    climb_speed = from_parameter("FW_T_CLMB_R_SP", minimum=_MIN_SPEED)
    sink_speed = from_parameter("FW_T_SINK_R_SP", minimum=_MIN_SPEED)
    lean_angle = from_parameter("FW_MAN_R_MAX", _DEGREE, minimum=0.05)
    pilot_climb_speed = computed(attrgetter("climb_speed"))
    pilot_yaw_rate = from_parameter("FW_MAN_YR_MAX", _DEGREE, minimum=0.05)
    acro_rate = from_parameter("FW_ACRO_X_MAX", _DEGREE, minimum=0.05)

    @computed
    def glide_slope(self) -> float:
        return tan(self.number("FW_LND_ANG", _DEGREE, minimum=0.02))

    @computed
    def flare_altitude(self) -> float:
        """The sink during FW_LND_FL_TIME in metres, at least FW_LND_FLALT."""
        sink = self.cruise_speed * self.glide_slope * self.number("FW_LND_FL_TIME", minimum=0.0)
        return max(self.number("FW_LND_FLALT", minimum=0.5), sink)

    @computed
    def acceptance_radius(self) -> float:
        """At least the distance that the guidance needs to turn onto the next line, in metres."""
        seconds = self.number("NPFG_PERIOD") * self.number("NPFG_DAMPING") * self.number("NPFG_SW_DST_MLT")
        return max(super().acceptance_radius, self.cruise_speed * seconds)


class VtolFlightParameters(MulticopterFlightParameters):
    """A multicopter in hover, a fixed wing after the transition."""

    limits: ClassVar[Limits] = MappingProxyType(
        {name: limit for name, limit in FixedWingFlightParameters.limits.items() if name != "FW_R_LIM"}
        | dict(MulticopterFlightParameters.limits)
    )
    cruise_speed = computed(attrgetter("_active.cruise_speed"))
    climb_speed = computed(attrgetter("_active.climb_speed"))
    sink_speed = computed(attrgetter("_active.sink_speed"))
    acceptance_radius = computed(attrgetter("_active.acceptance_radius"))
    glide_slope = computed(attrgetter("_wing.glide_slope"))
    flare_altitude = computed(attrgetter("_wing.flare_altitude"))
    lean_angle = computed(attrgetter("_active.lean_angle"))
    pilot_climb_speed = computed(attrgetter("_active.pilot_climb_speed"))
    circle_radius = computed(attrgetter("_active.circle_radius"))
    circle_speed = computed(attrgetter("_active.circle_speed"))

    def __init__(self, parameters: Parameters, body: Body) -> None:
        super().__init__(parameters)
        self._body = body
        self._hover = MulticopterFlightParameters(parameters)
        self._wing = FixedWingFlightParameters(parameters)

    @property
    def _active(self) -> MulticopterFlightParameters | FixedWingFlightParameters:
        return self._wing if self._body.flies_forward else self._hover


class RoverFlightParameters(Px4FlightParameters):
    """Rovers and boats."""

    limits: ClassVar[Limits] = MappingProxyType(
        {
            "RO_SPEED_LIM": ("speed", 1.0),
            "RO_ACCEL_LIM": ("acceleration", 1.0),
            "RO_YAW_RATE_LIM": ("turn_rate", _DEGREE),
        }
    )
    circle_radius = 10.0
    pilot_yaw_rate = from_parameter("RO_YAW_RATE_LIM", _DEGREE, minimum=0.05)
    acro_rate = computed(attrgetter("pilot_yaw_rate"))

    @computed
    def cruise_speed(self) -> float:
        """RO_SPEED_LIM in m/s; RO_MAX_THR_SPEED if it is negative (disabled)."""
        return max(self.number("RO_SPEED_LIM"), 0.0) or self.number("RO_MAX_THR_SPEED", default=2.0)


class SubmarineFlightParameters(Px4FlightParameters):
    """A submarine: depths are negative altitudes."""

    limits: ClassVar[Limits] = MappingProxyType({"UUV_PGM_VEL": ("speed", 2.0)})
    circle_radius = 5.0
    cruise_speed = from_parameter("UUV_PGM_VEL", minimum=_MIN_SPEED, default=0.5)

    @computed
    def acceptance_radius(self) -> float:
        """A tenth of the radius in the air, in metres."""
        return max(super().acceptance_radius / 10, _MIN_RADIUS)


def flight_parameters_of(vehicle: SimulatedVehicle) -> Px4FlightParameters:
    """Return the flight parameters of a vehicle."""
    parameters = vehicle.parameters
    match vehicle.vehicle_type:
        case VehicleType.COPTER:
            return MulticopterFlightParameters(parameters)
        case VehicleType.PLANE:
            return FixedWingFlightParameters(parameters)
        case VehicleType.VTOL:
            return VtolFlightParameters(parameters, vehicle.body)
        case VehicleType.SUB:
            return SubmarineFlightParameters(parameters)
    return RoverFlightParameters(parameters)
