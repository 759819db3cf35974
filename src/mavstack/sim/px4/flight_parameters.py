"""PX4's flight parameters: metres, seconds and degrees in the parameters, radians here.

An invalid value (zero or NaN) is replaced by the minimum that can be flown. `apply_limits` sets the limits of
the body at boot and whenever one of their parameters changes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf, isfinite, radians, tan
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.sim.autopilot.flight_parameters import FlightParameters
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

#: Limit of the body that a parameter sets, and the parameter's unit.
Limits: TypeAlias = Mapping[str, tuple[str, float]]


class Px4FlightParameters(FlightParameters):
    """Flight parameters of all types."""

    #: Limits of the body by parameter.
    limits: Limits = MappingProxyType({})
    #: The land detector disarms, because it knows whether there was a flight.
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
    def acceptance_radius(self) -> float:
        return self.number("NAV_ACC_RAD", minimum=_MIN_RADIUS)

    @property
    def loiter_radius(self) -> float:
        return self.number("NAV_LOITER_RAD", default=80.0) or 80.0

    @property
    def setpoint_timeout(self) -> float:
        return self.number("COM_OF_LOSS_T", minimum=_MIN_TIMEOUT, default=1.0)

    @property
    def land_speed(self) -> float:
        return self.sink_speed

    @property
    def circle_radius(self) -> float:
        return self.loiter_radius

    @property
    def circles_where_it_is(self) -> bool:
        return True

    @property
    def circle_speed(self) -> float:
        return self.cruise_speed

    @property
    def pilot_yaw_rate(self) -> float:
        return radians(60.0)


class _AircraftFlightParameters(Px4FlightParameters):
    """Take-off and return of all flying types."""

    @property
    def takeoff_altitude(self) -> float:  # type: ignore[override]
        return self.number("MIS_TAKEOFF_ALT", minimum=0.5)

    @property
    def return_altitude(self) -> float:  # type: ignore[override]
        return self.number("RTL_RETURN_ALT", minimum=0.0)

    @property
    def return_descend_altitude(self) -> float:  # type: ignore[override]
        return self.number("RTL_DESCEND_ALT", minimum=0.0)

    @property
    def return_loiter_time(self) -> float:  # type: ignore[override]
        delay = self.number("RTL_LAND_DELAY")
        return inf if delay < 0 else delay

    @property
    def return_cone_slope(self) -> float:  # type: ignore[override]
        """Slope of the cone above home with half angle RTL_CONE_ANG; 0 always climbs."""
        angle = self.number("RTL_CONE_ANG")
        return 1 / tan(radians(min(max(angle, _MIN_CONE_ANGLE), _MAX_CONE_ANGLE))) if angle > 0 else 0.0


class MulticopterFlightParameters(_AircraftFlightParameters):
    """A multicopter, and a VTOL in hover."""

    limits: Limits = MappingProxyType(
        {
            "MPC_ACC_HOR": ("acceleration", 1.0),
            "MPC_TILTMAX_AIR": ("tilt", _DEGREE),
            "MPC_XY_VEL_MAX": ("speed", 1.0),
        }
    )

    @property
    def cruise_speed(self) -> float:
        return self.number("MPC_XY_CRUISE", minimum=_MIN_SPEED)

    @property
    def climb_speed(self) -> float:  # type: ignore[override]
        return self.number("MPC_Z_V_AUTO_UP", minimum=_MIN_SPEED)

    @property
    def sink_speed(self) -> float:  # type: ignore[override]
        return self.number("MPC_Z_V_AUTO_DN", minimum=_MIN_SPEED)

    @property
    def land_speed(self) -> float:
        return self.number("MPC_LAND_SPEED", minimum=_MIN_SPEED)

    @property
    def land_slow_altitude(self) -> float:  # type: ignore[override]
        return self.number("MPC_LAND_ALT2", minimum=0.0)

    @property
    def lean_angle(self) -> float:  # type: ignore[override]
        return self.number("MPC_MAN_TILT_MAX", _DEGREE, minimum=0.05)

    @property
    def pilot_climb_speed(self) -> float:  # type: ignore[override]
        return self.number("MPC_Z_VEL_MAX_UP", minimum=_MIN_SPEED)

    @property
    def pilot_yaw_rate(self) -> float:
        return self.number("MPC_MAN_Y_MAX", _DEGREE, minimum=0.05)

    @property
    def acro_rate(self) -> float:  # type: ignore[override]
        return self.number("MC_ACRO_R_MAX", _DEGREE, minimum=0.05)

    @property
    def circle_radius(self) -> float:
        return 20.0

    @property
    def circle_speed(self) -> float:
        return min(self.cruise_speed, 3.0)


class FixedWingFlightParameters(_AircraftFlightParameters):
    """A fixed wing, and a VTOL in forward flight."""

    limits: Limits = MappingProxyType(
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

    @property
    def cruise_speed(self) -> float:
        return self.number("FW_AIRSPD_TRIM", minimum=5.0)

    @property
    def climb_speed(self) -> float:  # type: ignore[override]
        return self.number("FW_T_CLMB_R_SP", minimum=_MIN_SPEED)

    @property
    def sink_speed(self) -> float:  # type: ignore[override]
        return self.number("FW_T_SINK_R_SP", minimum=_MIN_SPEED)

    @property
    def glide_slope(self) -> float:  # type: ignore[override]
        return tan(self.number("FW_LND_ANG", _DEGREE, minimum=0.02))

    @property
    def flare_altitude(self) -> float:  # type: ignore[override]
        """The sink during FW_LND_FL_TIME in metres, at least FW_LND_FLALT."""
        sink = self.cruise_speed * self.glide_slope * self.number("FW_LND_FL_TIME", minimum=0.0)
        return max(self.number("FW_LND_FLALT", minimum=0.5), sink)

    @property
    def acceptance_radius(self) -> float:
        """At least the distance that the guidance needs to turn onto the next line, in metres."""
        seconds = self.number("NPFG_PERIOD") * self.number("NPFG_DAMPING") * self.number("NPFG_SW_DST_MLT")
        return max(super().acceptance_radius, self.cruise_speed * seconds)

    @property
    def lean_angle(self) -> float:  # type: ignore[override]
        return self.number("FW_MAN_R_MAX", _DEGREE, minimum=0.05)

    @property
    def pilot_climb_speed(self) -> float:  # type: ignore[override]
        return self.climb_speed

    @property
    def pilot_yaw_rate(self) -> float:
        return self.number("FW_MAN_YR_MAX", _DEGREE, minimum=0.05)

    @property
    def acro_rate(self) -> float:  # type: ignore[override]
        return self.number("FW_ACRO_X_MAX", _DEGREE, minimum=0.05)


class VtolFlightParameters(MulticopterFlightParameters):
    """A multicopter in hover, a fixed wing after the transition."""

    limits: Limits = MappingProxyType(
        {name: limit for name, limit in FixedWingFlightParameters.limits.items() if name != "FW_R_LIM"}
        | dict(MulticopterFlightParameters.limits)
    )

    def __init__(self, parameters: Parameters, body: Body) -> None:
        super().__init__(parameters)
        self._body = body
        self._hover, self._wing = (
            MulticopterFlightParameters(parameters),
            FixedWingFlightParameters(parameters),
        )

    @property
    def _active(self) -> MulticopterFlightParameters | FixedWingFlightParameters:
        return self._wing if self._body.flies_forward else self._hover

    @property
    def cruise_speed(self) -> float:
        return self._active.cruise_speed

    @property
    def climb_speed(self) -> float:  # type: ignore[override]
        return self._active.climb_speed

    @property
    def sink_speed(self) -> float:  # type: ignore[override]
        return self._active.sink_speed

    @property
    def acceptance_radius(self) -> float:
        return self._active.acceptance_radius

    @property
    def glide_slope(self) -> float:  # type: ignore[override]
        return self._wing.glide_slope

    @property
    def flare_altitude(self) -> float:  # type: ignore[override]
        return self._wing.flare_altitude

    @property
    def lean_angle(self) -> float:  # type: ignore[override]
        return self._active.lean_angle

    @property
    def pilot_climb_speed(self) -> float:  # type: ignore[override]
        return self._active.pilot_climb_speed

    @property
    def circle_radius(self) -> float:
        return self._active.circle_radius

    @property
    def circle_speed(self) -> float:
        return self._active.circle_speed


class RoverFlightParameters(Px4FlightParameters):
    """Rovers and boats."""

    limits: Limits = MappingProxyType(
        {
            "RO_SPEED_LIM": ("speed", 1.0),
            "RO_ACCEL_LIM": ("acceleration", 1.0),
            "RO_YAW_RATE_LIM": ("turn_rate", _DEGREE),
        }
    )
    circle_radius = 10.0

    @property
    def cruise_speed(self) -> float:
        """RO_SPEED_LIM in m/s; RO_MAX_THR_SPEED if it is negative (disabled)."""
        return max(self.number("RO_SPEED_LIM"), 0.0) or self.number("RO_MAX_THR_SPEED", default=2.0)

    @property
    def pilot_yaw_rate(self) -> float:
        return self.number("RO_YAW_RATE_LIM", _DEGREE, minimum=0.05)

    @property
    def acro_rate(self) -> float:  # type: ignore[override]
        return self.pilot_yaw_rate


class SubmarineFlightParameters(Px4FlightParameters):
    """A submarine: depths are negative altitudes."""

    limits: Limits = MappingProxyType({"UUV_PGM_VEL": ("speed", 2.0)})
    circle_radius = 5.0

    @property
    def cruise_speed(self) -> float:
        return self.number("UUV_PGM_VEL", minimum=_MIN_SPEED, default=0.5)

    @property
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


def _limit_setter(
    flight_parameters: Px4FlightParameters, body: Body, name: str, limit: str, unit: float
) -> Callable[[object], None]:
    """Return the callback that sets a limit from a parameter."""

    def set_limit(value: object) -> None:
        number = flight_parameters.number(name, unit)
        if number > 0:
            body.set_limit(limit, number)

    return set_limit
