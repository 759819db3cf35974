"""How fast, how high, how near: the flight parameters that behaviours fly by, each from a parameter of the firmware.

All are in metres, seconds and radians; they are read when they are needed, so that a parameter that is set
in flight counts at once.
"""

from __future__ import annotations

from abc import ABC, abstractmethod


class FlightParameters(ABC):
    """What behaviours ask for; a firmware answers from its parameters."""

    @property
    @abstractmethod
    def takeoff_altitude(self) -> float:
        """Of a take-off that names none, above the ground."""

    @property
    @abstractmethod
    def cruise_speed(self) -> float:
        """Over ground for what hovers, drives or swims; through the air for a wing."""

    @property
    @abstractmethod
    def climb_speed(self) -> float:
        """Upwards."""

    @property
    @abstractmethod
    def sink_speed(self) -> float:
        """Downwards, positive."""

    @property
    @abstractmethod
    def land_speed(self) -> float:
        """Downwards near the ground, positive."""

    @property
    @abstractmethod
    def acceptance_radius(self) -> float:
        """How near counts as reached."""

    @property
    @abstractmethod
    def loiter_radius(self) -> float:
        """Of circles that name none; negative: counter-clockwise."""

    @property
    @abstractmethod
    def return_altitude(self) -> float:
        """Above home, on the way back; -infinite: as high as it is."""

    @property
    @abstractmethod
    def return_loiter_time(self) -> float:
        """Over home before landing; infinite: stay there."""

    @property
    @abstractmethod
    def setpoint_timeout(self) -> float:
        """How long a velocity that is not repeated is flown."""

    @property
    @abstractmethod
    def disarm_delay(self) -> float:
        """From landing to disarming; infinite: never by itself."""

    # By hand

    @property
    @abstractmethod
    def lean_angle(self) -> float:
        """The most that the pilot's sticks lean what hovers, or bank a wing."""

    @property
    @abstractmethod
    def pilot_climb_speed(self) -> float:
        """Upwards and downwards, at full throttle stick."""

    @property
    @abstractmethod
    def pilot_yaw_rate(self) -> float:
        """At full yaw stick."""

    @property
    @abstractmethod
    def acro_rate(self) -> float:
        """Of roll and pitch, at full stick in rate modes."""

    # Landing and coming home

    @property
    @abstractmethod
    def land_slow_altitude(self) -> float:
        """Below this height above the ground it sinks at `land_speed`."""

    @property
    @abstractmethod
    def land_disarm_delay(self) -> float:
        """From touch-down of a landing to disarming; `disarm_delay` is for all other modes."""

    @property
    @abstractmethod
    def return_descend_altitude(self) -> float:
        """Above home, where `return_loiter_time` is spent; infinite: as high as it came back."""

    @property
    @abstractmethod
    def return_cone_slope(self) -> float:
        """Near home it climbs only to distance x slope before it returns; 0: always to `return_altitude`."""

    @property
    @abstractmethod
    def glide_slope(self) -> float:
        """Height over distance of a wing's final approach."""

    @property
    @abstractmethod
    def flare_altitude(self) -> float:
        """Above the ground, where a wing that lands raises its nose."""

    # Circles

    @property
    @abstractmethod
    def circle_radius(self) -> float:
        """Of the mode that circles or orbits; negative: counter-clockwise."""

    @property
    @abstractmethod
    def circles_where_it_is(self) -> bool:
        """Whether the mode circles the place where it was entered, rather than one a radius ahead."""

    @property
    @abstractmethod
    def circle_speed(self) -> float:
        """Along that circle, for what hovers, drives or swims."""

    # Guided

    @property
    @abstractmethod
    def setpoint_frames(self) -> frozenset[int]:
        """MAV_FRAMEs that are followed in SET_POSITION_TARGET_LOCAL_NED; others are ignored."""

    @property
    @abstractmethod
    def thrust_is_climb(self) -> bool:
        """Whether the thrust of an attitude setpoint means climbing (0.5: stay), not thrust."""

    @property
    @abstractmethod
    def forward_beyond(self) -> float:
        """A VTOL that hovers flies forward to what is farther than this; infinite: it stays as it is."""
