"""The state of a vehicle as converters read it: messages, clock, frames; live, or from a log."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import radians
from typing import TYPE_CHECKING, Final, TypeAlias, TypeVar

from mavstack.bridges.core.boot_clock import BootClock
from mavstack.bridges.core.frames import frd_flu, ros_attitude_of, to_ros_attitude
from mavstack.bridges.core.geoid import undulation
from mavstack.dialects import Message, common

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.rotation import Quaternion

AnyMessage = TypeVar("AnyMessage", bound=Message)


@dataclass(frozen=True, slots=True)
class Frames:
    """The names of the frames in headers and transforms."""

    base_link: str = "base_link"
    map: str = "map"
    odom: str = "odom"
    earth: str = "earth"

    def name_of(self, key: str) -> str:
        """Return the frame name for the key of a row: "" for an empty key, and the key if it is unknown."""
        return getattr(self, key, key) if key else ""

    def prefixed(self, prefix: str) -> Frames:
        """Return the frames of one of several vehicles; the Earth is common to all."""
        base_link, local, odom = (f"{prefix}/{name}" for name in (self.base_link, self.map, self.odom))
        return Frames(base_link, local, odom, self.earth)


#: A covariance matrix of three axes, row by row.
Covariance: TypeAlias = tuple[float, ...]


def uncorrelated(deviation: float) -> Covariance:
    """Return the covariance of three axes with the same standard deviation."""
    square = deviation * deviation
    return square, 0.0, 0.0, 0.0, square, 0.0, 0.0, 0.0, square


_ACCELERATION: Final = uncorrelated(0.0003)
_RATE: Final = uncorrelated(radians(0.02))
_ORIENTATION: Final = uncorrelated(1.0)


@dataclass(slots=True)
class Noise:
    """The noise of sensors, which MAVLink does not report.

    Attributes:
        acceleration: The covariance of accelerations, for 0.0003 m/s² on each axis.
        rate: The covariance of angular rates, for 0.02 degrees per second on each axis.
        orientation: The covariance of attitudes, for 1 rad on each axis.
        uere: The user equivalent range error of satellite navigation in metres.
    """

    acceleration: Covariance = _ACCELERATION
    rate: Covariance = _RATE
    orientation: Covariance = _ORIENTATION
    uere: float = 1.0


@dataclass(slots=True)
class VehicleView:
    """The state of a vehicle that converters read.

    Attributes:
        latest: Returns the last message of a class from the autopilot, or None.
        system: The system id.
        frames: The names of frames.
        noise: The noise of sensors.
        clock: The wall clock of the vehicle's times.
        arrival: The Unix time in nanoseconds at which the present message arrived.
        connected: Heartbeats arrive.
        reason: The text of the last refusal.
    """

    latest: Callable[[type[AnyMessage]], AnyMessage | None]
    system: int = 1
    frames: Frames = field(default_factory=Frames)
    noise: Noise = field(default_factory=Noise)
    clock: BootClock = field(default_factory=BootClock)
    arrival: int = 0
    connected: bool = True
    reason: str = ""
    _origin: tuple[float, float, float] | None = None

    def stamp(self, message: Message | None) -> int:
        """Return the Unix time of a message in nanoseconds, by its own time if it has one."""
        boot = getattr(message, "time_boot_ms", None)
        if boot is not None:
            return self.clock.from_boot(boot * 1_000_000, self.arrival)
        time = getattr(message, "time_usec", None)
        return self.arrival if time is None else self.clock.from_microseconds(time, self.arrival)

    def attitude(self) -> Quaternion:
        """Return the last attitude, FLU in ENU, as (x, y, z, w); level and north before the first one."""
        quaternion = self.latest(common.AttitudeQuaternion)
        angles = self.latest(common.Attitude)
        if quaternion is not None and (angles is None or quaternion.time_boot_ms >= angles.time_boot_ms):
            return to_ros_attitude(quaternion.q1, quaternion.q2, quaternion.q3, quaternion.q4)
        if angles is None:
            return to_ros_attitude(1.0, 0.0, 0.0, 0.0)
        return ros_attitude_of(angles.roll, angles.pitch, angles.yaw)

    def rates(self) -> tuple[float, float, float]:
        """Return the last angular rates in FLU, rad/s; zero before the first ones."""
        angles = self.latest(common.Attitude) or self.latest(common.AttitudeQuaternion)
        if angles is None:
            return 0.0, 0.0, 0.0
        return frd_flu(angles.rollspeed, angles.pitchspeed, angles.yawspeed)

    def origin(self) -> tuple[float, float, float] | None:
        """Return the origin of the local frame: latitude, longitude in degrees, metres above sea level."""
        reported = self.latest(common.GpsGlobalOrigin) or self.latest(common.HomePosition)
        if reported is not None:
            return reported.latitude / 1e7, reported.longitude / 1e7, reported.altitude / 1e3
        return self._origin

    def set_first_fix(self, latitude: float, longitude: float, altitude: float) -> None:
        """Take a position as the origin if the vehicle reports none."""
        if self._origin is None:
            self._origin = latitude, longitude, altitude


def to_ellipsoid(latitude: float, longitude: float, altitude: float) -> float:
    """Return the height above the ellipsoid for an altitude above mean sea level, in metres."""
    return altitude + undulation(latitude, longitude)


def to_sea_level(latitude: float, longitude: float, height: float) -> float:
    """Return the altitude above mean sea level for a height above the ellipsoid, in metres."""
    return height - undulation(latitude, longitude)
