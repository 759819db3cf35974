"""PX4's flight parameters: metres, seconds and degrees in the parameters, radians here.

What a parameter cannot mean (nothing, or no number) is replaced by the least that can be flown. The limits of
the body follow the parameters: `follow` sets them at boot and whenever one of them changes.
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
    from mavstack.sim.autopilot.interfaces import Vehicle
    from mavstack.sim.motion import Body
    from mavstack.sim.parameters import Parameters

_F = common.MavFrame
_DEGREE: Final = radians(1.0)
_SLOWEST, _SMALLEST_RADIUS = 0.1, 0.3
_FLAT, _STEEP = 0.5, 89.5
_SHORTEST_PATIENCE = 0.1

#: Which limits of the body a parameter sets, and in which unit the parameter is.
Limits: TypeAlias = Mapping[str, tuple[str, float]]


class Px4FlightParameters(FlightParameters):
    """What all types have in common."""

    #: Parameter to limit of the body.
    limits: Limits = MappingProxyType({})
    #: Disarming is the business of `landing.py`, which knows whether there was a flight.
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
    def acceptance_radius(self) -> float:
        return self.number("NAV_ACC_RAD", least=_SMALLEST_RADIUS)

    @property
    def loiter_radius(self) -> float:
        return self.number("NAV_LOITER_RAD", default=80.0) or 80.0

    @property
    def setpoint_timeout(self) -> float:
        return self.number("COM_OF_LOSS_T", least=_SHORTEST_PATIENCE, default=1.0)

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


class _ReturningFlightParameters(Px4FlightParameters):
    """What all flying types have in common: taking off, and coming home."""

    @property
    def takeoff_altitude(self) -> float:  # type: ignore[override]
        return self.number("MIS_TAKEOFF_ALT", least=0.5)

    @property
    def return_altitude(self) -> float:  # type: ignore[override]
        return self.number("RTL_RETURN_ALT", least=0.0)

    @property
    def return_descend_altitude(self) -> float:  # type: ignore[override]
        return self.number("RTL_DESCEND_ALT", least=0.0)

    @property
    def return_loiter_time(self) -> float:  # type: ignore[override]
        delay = self.number("RTL_LAND_DELAY")
        return inf if delay < 0 else delay

    @property
    def return_cone_slope(self) -> float:  # type: ignore[override]
        """From the half angle of a cone that stands on home; without one it always climbs."""
        angle = self.number("RTL_CONE_ANG")
        return 1 / tan(radians(min(max(angle, _FLAT), _STEEP))) if angle > 0 else 0.0


class MulticopterFlightParameters(_ReturningFlightParameters):
    """A multicopter, and a VTOL that hovers."""

    limits: Limits = MappingProxyType(
        {
            "MPC_ACC_HOR": ("acceleration", 1.0),
            "MPC_TILTMAX_AIR": ("tilt", _DEGREE),
            "MPC_XY_VEL_MAX": ("speed", 1.0),
        }
    )

    @property
    def cruise_speed(self) -> float:
        return self.number("MPC_XY_CRUISE", least=_SLOWEST)

    @property
    def climb_speed(self) -> float:  # type: ignore[override]
        return self.number("MPC_Z_V_AUTO_UP", least=_SLOWEST)

    @property
    def sink_speed(self) -> float:  # type: ignore[override]
        return self.number("MPC_Z_V_AUTO_DN", least=_SLOWEST)

    @property
    def land_speed(self) -> float:
        return self.number("MPC_LAND_SPEED", least=_SLOWEST)

    @property
    def land_slow_altitude(self) -> float:  # type: ignore[override]
        return self.number("MPC_LAND_ALT2", least=0.0)

    @property
    def lean_angle(self) -> float:  # type: ignore[override]
        return self.number("MPC_MAN_TILT_MAX", _DEGREE, least=0.05)

    @property
    def pilot_climb_speed(self) -> float:  # type: ignore[override]
        return self.number("MPC_Z_VEL_MAX_UP", least=_SLOWEST)

    @property
    def pilot_yaw_rate(self) -> float:
        return self.number("MPC_MAN_Y_MAX", _DEGREE, least=0.05)

    @property
    def acro_rate(self) -> float:  # type: ignore[override]
        return self.number("MC_ACRO_R_MAX", _DEGREE, least=0.05)

    @property
    def circle_radius(self) -> float:
        return 20.0

    @property
    def circle_speed(self) -> float:
        return min(self.cruise_speed, 3.0)


class FixedWingFlightParameters(_ReturningFlightParameters):
    """A fixed wing, and a VTOL that flies on its wing."""

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
        return self.number("FW_AIRSPD_TRIM", least=5.0)

    @property
    def climb_speed(self) -> float:  # type: ignore[override]
        return self.number("FW_T_CLMB_R_SP", least=_SLOWEST)

    @property
    def sink_speed(self) -> float:  # type: ignore[override]
        return self.number("FW_T_SINK_R_SP", least=_SLOWEST)

    @property
    def glide_slope(self) -> float:  # type: ignore[override]
        return tan(self.number("FW_LND_ANG", _DEGREE, least=0.02))

    @property
    def flare_altitude(self) -> float:  # type: ignore[override]
        """As high as it sinks in the time of the flare, and not lower than its parameter."""
        sink = self.cruise_speed * self.glide_slope * self.number("FW_LND_FL_TIME", least=0.0)
        return max(self.number("FW_LND_FLALT", least=0.5), sink)

    @property
    def acceptance_radius(self) -> float:
        """At least as far as the guidance needs to turn onto the next line."""
        seconds = self.number("NPFG_PERIOD") * self.number("NPFG_DAMPING") * self.number("NPFG_SW_DST_MLT")
        return max(super().acceptance_radius, self.cruise_speed * seconds)

    @property
    def lean_angle(self) -> float:  # type: ignore[override]
        return self.number("FW_MAN_R_MAX", _DEGREE, least=0.05)

    @property
    def pilot_climb_speed(self) -> float:  # type: ignore[override]
        return self.climb_speed

    @property
    def pilot_yaw_rate(self) -> float:
        return self.number("FW_MAN_YR_MAX", _DEGREE, least=0.05)

    @property
    def acro_rate(self) -> float:  # type: ignore[override]
        return self.number("FW_ACRO_X_MAX", _DEGREE, least=0.05)


class VtolFlightParameters(MulticopterFlightParameters):
    """A multicopter that is a wing from its transition on."""

    limits: Limits = MappingProxyType(
        {name: limit for name, limit in FixedWingFlightParameters.limits.items() if name != "FW_R_LIM"}
        | dict(MulticopterFlightParameters.limits)
    )

    def __init__(self, parameters: Parameters, body: Body) -> None:
        super().__init__(parameters)
        self._body = body
        self._hovering, self._winged = (
            MulticopterFlightParameters(parameters),
            FixedWingFlightParameters(parameters),
        )

    @property
    def _now(self) -> MulticopterFlightParameters | FixedWingFlightParameters:
        return self._winged if self._body.flies_forward else self._hovering

    @property
    def cruise_speed(self) -> float:
        return self._now.cruise_speed

    @property
    def climb_speed(self) -> float:  # type: ignore[override]
        return self._now.climb_speed

    @property
    def sink_speed(self) -> float:  # type: ignore[override]
        return self._now.sink_speed

    @property
    def acceptance_radius(self) -> float:
        return self._now.acceptance_radius

    @property
    def glide_slope(self) -> float:  # type: ignore[override]
        return self._winged.glide_slope

    @property
    def flare_altitude(self) -> float:  # type: ignore[override]
        return self._winged.flare_altitude

    @property
    def lean_angle(self) -> float:  # type: ignore[override]
        return self._now.lean_angle

    @property
    def pilot_climb_speed(self) -> float:  # type: ignore[override]
        return self._now.pilot_climb_speed

    @property
    def circle_radius(self) -> float:
        return self._now.circle_radius

    @property
    def circle_speed(self) -> float:
        return self._now.circle_speed


class RoverFlightParameters(Px4FlightParameters):
    """What drives or floats."""

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
        """RO_SPEED_LIM, unless it is switched off by a number below 0."""
        return max(self.number("RO_SPEED_LIM"), 0.0) or self.number("RO_MAX_THR_SPEED", default=2.0)

    @property
    def pilot_yaw_rate(self) -> float:
        return self.number("RO_YAW_RATE_LIM", _DEGREE, least=0.05)

    @property
    def acro_rate(self) -> float:  # type: ignore[override]
        return self.pilot_yaw_rate


class SubmarineFlightParameters(Px4FlightParameters):
    """A submarine: depths are altitudes below 0."""

    limits: Limits = MappingProxyType({"UUV_PGM_VEL": ("speed", 2.0)})
    circle_radius = 5.0

    @property
    def cruise_speed(self) -> float:
        return self.number("UUV_PGM_VEL", least=_SLOWEST, default=0.5)

    @property
    def acceptance_radius(self) -> float:
        """A submarine's is a tenth of what is usual in the air."""
        return max(super().acceptance_radius / 10, _SMALLEST_RADIUS)


def flight_parameters_of(vehicle: Vehicle) -> Px4FlightParameters:
    """The flight parameters of a vehicle."""
    parameters = vehicle.parameters
    match vehicle.type:
        case VehicleType.COPTER:
            return MulticopterFlightParameters(parameters)
        case VehicleType.PLANE:
            return FixedWingFlightParameters(parameters)
        case VehicleType.VTOL:
            return VtolFlightParameters(parameters, vehicle.body)
        case VehicleType.SUB:
            return SubmarineFlightParameters(parameters)
    return RoverFlightParameters(parameters)


def _pusher(
    flight_parameters: Px4FlightParameters, body: Body, name: str, limit: str, unit: float
) -> Callable[[object], None]:
    def push(value: object) -> None:
        number = flight_parameters.number(name, unit)
        if number > 0:
            body.set_limit(limit, number)

    return push
