"""Flight parameters: the speeds, altitudes and radii that behaviours use.

Each is computed from a parameter of the firmware, in metres, seconds and radians, at the moment of use, so
that a parameter that is set in flight takes effect immediately.
"""

from __future__ import annotations

from abc import ABC, abstractmethod


class FlightParameters(ABC):
    """The flight parameters of one vehicle; each firmware computes them from its own parameters."""

    @property
    @abstractmethod
    def takeoff_altitude(self) -> float:
        """Default altitude of a takeoff, in metres above the ground."""

    @property
    @abstractmethod
    def cruise_speed(self) -> float:
        """Speed in m/s: over ground for a vehicle that can stop, through the air for a wing."""

    @property
    @abstractmethod
    def climb_speed(self) -> float:
        """Climb rate, in m/s."""

    @property
    @abstractmethod
    def sink_speed(self) -> float:
        """Descent rate, in m/s, positive."""

    @property
    @abstractmethod
    def land_speed(self) -> float:
        """Descent rate near the ground, in m/s, positive."""

    @property
    @abstractmethod
    def acceptance_radius(self) -> float:
        """Distance at which a point counts as reached, in metres."""

    @property
    @abstractmethod
    def loiter_radius(self) -> float:
        """Default radius of a circle, in metres; negative means counter-clockwise."""

    @property
    @abstractmethod
    def return_altitude(self) -> float:
        """Altitude of the return, in metres above home; -infinity keeps the current altitude."""

    @property
    @abstractmethod
    def return_loiter_time(self) -> float:
        """Wait above home before the landing, in seconds; infinity stays there."""

    @property
    @abstractmethod
    def setpoint_timeout(self) -> float:
        """Time that a velocity setpoint is flown if it is not repeated, in seconds."""

    @property
    @abstractmethod
    def disarm_delay(self) -> float:
        """Time from landing to disarming, in seconds; infinity never disarms."""

    # Manual flight

    @property
    @abstractmethod
    def lean_angle(self) -> float:
        """Maximum lean of a hovering vehicle or bank of a wing at full stick, in radians."""

    @property
    @abstractmethod
    def pilot_climb_speed(self) -> float:
        """Climb and descent rate at full throttle stick, in m/s."""

    @property
    @abstractmethod
    def pilot_yaw_rate(self) -> float:
        """Yaw rate at full stick, in rad/s."""

    @property
    @abstractmethod
    def acro_rate(self) -> float:
        """Roll and pitch rate at full stick in rate modes, in rad/s."""

    # Landing and return

    @property
    @abstractmethod
    def land_slow_altitude(self) -> float:
        """Height above the ground below which the vehicle descends at `land_speed`, in metres."""

    @property
    @abstractmethod
    def land_disarm_delay(self) -> float:
        """Time from the touchdown of a landing to disarming, in seconds; other modes use `disarm_delay`."""

    @property
    @abstractmethod
    def return_descend_altitude(self) -> float:
        """Altitude of the wait above home, in metres above home; infinity keeps the return altitude."""

    @property
    @abstractmethod
    def return_cone_slope(self) -> float:
        """Climb of a return near home, as altitude over distance; 0 climbs to `return_altitude`."""

    @property
    @abstractmethod
    def glide_slope(self) -> float:
        """Height over distance of a wing's final approach."""

    @property
    @abstractmethod
    def flare_altitude(self) -> float:
        """Height above the ground where a landing wing raises its nose, in metres."""

    # Circles

    @property
    @abstractmethod
    def circle_radius(self) -> float:
        """Radius of the circle or orbit mode, in metres; negative means counter-clockwise."""

    @property
    @abstractmethod
    def circles_where_it_is(self) -> bool:
        """True if the circle mode circles the current position, not a point one radius ahead."""

    @property
    @abstractmethod
    def circle_speed(self) -> float:
        """Speed along the circle of that mode, in m/s; wings fly at their cruise speed."""

    # Guided flight

    @property
    @abstractmethod
    def setpoint_frames(self) -> frozenset[int]:
        """The frames that SET_POSITION_TARGET_LOCAL_NED may use; setpoints in other frames are ignored."""

    #: False if only the altitude of position setpoints is followed, as by ArduPlane.
    follows_positions = True

    @property
    @abstractmethod
    def thrust_is_climb(self) -> bool:
        """True if the thrust of an attitude setpoint means a climb rate (0.5 holds the altitude)."""

    @property
    @abstractmethod
    def forward_beyond(self) -> float:
        """Distance beyond which a hovering VTOL flies forward, in metres; infinity never."""
