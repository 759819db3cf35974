"""ArduPilot's flight parameters by vehicle type, each from the parameters of its firmware.

Copter and Sub use centimetres, Plane and Rover metres.
"""

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
from mavstack.sim.ardupilot.plane_flight_parameters import PlaneFlightParameters, QuadplaneFlightParameters
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle

_MILLISECOND = 0.001
#: Bit of GUID_OPTIONS.
_THRUST_AS_THRUST = 1 << 3


class CopterFlightParameters(ArdupilotFlightParameters):
    """ArduCopter."""

    limits: ClassVar[Limits] = MappingProxyType(
        {
            "WPNAV_ACCEL": ("acceleration", CM),
            "ANGLE_MAX": ("tilt", CENTIDEGREE),
            "LOIT_SPEED": ("speed", CM),
        }
    )

    @property
    def takeoff_altitude(self) -> float:
        return self.number("PILOT_TKOFF_ALT", CM) or 10.0

    @property
    def cruise_speed(self) -> float:
        return self.number("WPNAV_SPEED", CM, minimum=MIN_SPEED)

    @property
    def climb_speed(self) -> float:
        return self.number("WPNAV_SPEED_UP", CM, minimum=MIN_SPEED)

    @property
    def sink_speed(self) -> float:
        return self.number("WPNAV_SPEED_DN", CM, minimum=MIN_SPEED)

    @property
    def land_speed(self) -> float:
        return self.number("LAND_SPEED", CM, minimum=MIN_SPEED)

    @property
    def acceptance_radius(self) -> float:
        return self.number("WPNAV_RADIUS", CM, minimum=MIN_RADIUS)

    @property
    def loiter_radius(self) -> float:
        return self.number("CIRCLE_RADIUS", CM)

    @property
    def return_altitude(self) -> float:
        return self.number("RTL_ALT", CM, minimum=0.0)

    @property
    def return_loiter_time(self) -> float:
        """Seconds over home; infinite with a final altitude, at which the copter stays."""
        if self.number("RTL_ALT_FINAL", CM) > 0:
            return inf
        return self.number("RTL_LOIT_TIME", _MILLISECOND, minimum=0.0)

    @property
    def setpoint_timeout(self) -> float:
        return self.number("GUID_TIMEOUT", minimum=0.1, default=3.0)

    @property
    def disarm_delay(self) -> float:
        return self.number("DISARM_DELAY") or inf

    @property
    def land_disarm_delay(self) -> float:
        """Seconds; copters disarm right after an automatic landing."""
        return 1.0

    @property
    def land_slow_altitude(self) -> float:
        return self.number("LAND_ALT_LOW", CM, minimum=1.0, default=10.0)

    @property
    def return_descend_altitude(self) -> float:
        return self.number("RTL_ALT_FINAL", CM) or inf

    @property
    def return_cone_slope(self) -> float:
        return self.number("RTL_CONE_SLOPE", minimum=0.0, default=3.0)

    @property
    def thrust_is_climb(self) -> bool:
        """True unless GUID_OPTIONS selects thrust."""
        return not int(self.number("GUID_OPTIONS")) & _THRUST_AS_THRUST


class RoverFlightParameters(ArdupilotFlightParameters):
    """Rovers and boats."""

    limits: ClassVar[Limits] = MappingProxyType(
        {"WP_SPEED": ("speed", 1.0), "ATC_ACCEL_MAX": ("acceleration", 1.0)}
    )

    @property
    def return_altitude(self) -> float:
        return 0.0

    @property
    def climb_speed(self) -> float:
        return 0.5

    @property
    def sink_speed(self) -> float:
        return 0.5

    @property
    def takeoff_altitude(self) -> float:
        return 0.0

    @property
    def thrust_is_climb(self) -> bool:
        return False

    @property
    def cruise_speed(self) -> float:
        return self.number("WP_SPEED") or self.number("CRUISE_SPEED", minimum=MIN_SPEED)

    @property
    def acceptance_radius(self) -> float:
        return self.number("WP_RADIUS", minimum=MIN_RADIUS)

    @property
    def loiter_radius(self) -> float:
        return self.circle_radius

    @property
    def circle_radius(self) -> float:
        radius = self.number("CIRC_RADIUS", default=20.0) or 20.0
        return -radius if int(self.number("CIRC_DIR")) == 1 else radius

    @property
    def circle_speed(self) -> float:
        return self.number("CIRC_SPEED") or self.cruise_speed

    @property
    def pilot_yaw_rate(self) -> float:
        return self.number("ACRO_TURN_RATE", radians(1.0), minimum=0.1, default=radians(180.0))


class SubFlightParameters(ArdupilotFlightParameters):
    """ArduSub: depths are negative altitudes."""

    limits: ClassVar[Limits] = MappingProxyType(
        {"WPNAV_ACCEL": ("acceleration", CM), "LOIT_SPEED": ("speed", CM)}
    )

    @property
    def takeoff_altitude(self) -> float:
        return 0.0

    @property
    def cruise_speed(self) -> float:
        return self.number("WPNAV_SPEED", CM, minimum=MIN_SPEED)

    @property
    def climb_speed(self) -> float:
        return self.number("WPNAV_SPEED_UP", CM, minimum=MIN_SPEED)

    @property
    def sink_speed(self) -> float:
        return self.number("WPNAV_SPEED_DN", CM, minimum=MIN_SPEED)

    @property
    def acceptance_radius(self) -> float:
        return self.number("WPNAV_RADIUS", CM, minimum=MIN_RADIUS)

    @property
    def loiter_radius(self) -> float:
        return self.number("CIRCLE_RADIUS", CM)

    @property
    def return_altitude(self) -> float:
        """Surface depth as a negative altitude in metres."""
        return min(self.number("SURFACE_DEPTH", CM, default=-0.1), 0.0)


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
