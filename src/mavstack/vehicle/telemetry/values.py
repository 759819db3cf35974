"""What a vehicle tells, in SI units and degrees, the same of every firmware.

None stands for what the vehicle does not know, or says that it does not. Directions are degrees clockwise
from north; north, east and down are the axes of the local frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, degrees, hypot
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from mavstack.dialects import common

Vector: TypeAlias = "tuple[float, float, float]"

_FIX_3D = 3


@dataclass(frozen=True, slots=True)
class Position:
    """Where it is: altitude above mean sea level, and above home, in metres; heading in 0 to 360 degrees."""

    latitude: float
    longitude: float
    altitude: float | None = None
    relative_altitude: float | None = None
    heading: float | None = None


@dataclass(frozen=True, slots=True)
class LocalPosition:
    """Where it is, in metres from the origin of its own frame."""

    north: float
    east: float
    down: float


@dataclass(frozen=True, slots=True)
class Velocity:
    """How fast it moves over the ground, in m/s."""

    north: float
    east: float
    down: float

    @property
    def ground_speed(self) -> float:
        """Its speed along the ground."""
        return hypot(self.north, self.east)


@dataclass(frozen=True, slots=True)
class Attitude:
    """How it is turned, in degrees (yaw from -180 to 180), and how fast it turns, in degrees a second."""

    roll: float
    pitch: float
    yaw: float
    roll_rate: float | None = None
    pitch_rate: float | None = None
    yaw_rate: float | None = None

    @property
    def heading(self) -> float:
        """Its yaw as a heading of 0 to 360 degrees."""
        return self.yaw % 360.0


@dataclass(frozen=True, slots=True)
class VfrHud:
    """VfrHud in m/s as a pilot wants them, and the throttle in remaining."""

    airspeed: float | None
    ground_speed: float | None
    climb: float | None
    throttle: float | None


@dataclass(frozen=True, slots=True)
class Gps:
    """What its receiver says: fix, satellites, dilution, place in degrees and metres, accuracy in metres.

    `course` is where it moves, `heading` where it points if the receiver has two antennas.
    """

    fix: common.GpsFixType | int
    satellites: int | None = None
    hdop: float | None = None
    vdop: float | None = None
    latitude: float | None = None
    longitude: float | None = None
    altitude: float | None = None
    ground_speed: float | None = None
    course: float | None = None
    heading: float | None = None
    horizontal_accuracy: float | None = None
    vertical_accuracy: float | None = None

    @property
    def has_fix(self) -> bool:
        """Whether it knows its place in all three dimensions."""
        return self.fix >= _FIX_3D


@dataclass(frozen=True, slots=True)
class Battery:
    """A battery: voltage, current, remaining left, mAh taken, degrees Celsius, voltage of cells, seconds left."""

    id: int = 0
    voltage: float | None = None
    current: float | None = None
    remaining: float | None = None
    consumed: float | None = None
    temperature: float | None = None
    cells: tuple[float, ...] = ()
    time_remaining: float | None = None
    charge_state: common.MavBatteryChargeState | int | None = None
    faults: common.MavBatteryFault | int = 0


@dataclass(frozen=True, slots=True)
class HomePosition:
    """Where it was armed, or was told that home is: degrees, and metres above mean sea level."""

    latitude: float
    longitude: float
    altitude: float


@dataclass(frozen=True, slots=True)
class Rc:
    """The radio control: pulses of each channel in microseconds, None if unused; `rssi` in 0 to 254."""

    channels: tuple[int | None, ...]
    rssi: int | None = None


@dataclass(frozen=True, slots=True)
class Wind:
    """Where the air moves to, in m/s."""

    north: float
    east: float
    down: float | None = None

    @property
    def speed(self) -> float:
        """Its speed along the ground."""
        return hypot(self.north, self.east)

    @property
    def direction(self) -> float:
        """The direction that it comes from, as a weather report says it."""
        return degrees(atan2(-self.east, -self.north)) % 360.0


@dataclass(frozen=True, slots=True)
class Imu:
    """What its inertial unit feels, in the body's axes: m/s², degrees a second, gauss, degrees Celsius."""

    acceleration: Vector
    rotation: Vector
    magnetic_field: Vector | None = None
    temperature: float | None = None


@dataclass(frozen=True, slots=True)
class Odometry:
    """Place, attitude (w, x, y, z) and motion in the frames that it names; `quality` in remaining.

    Metres, m/s and degrees a second; position in `frame`, velocity and rotation in `child_frame`.
    """

    frame: common.MavFrame | int
    child_frame: common.MavFrame | int
    position: Vector | None
    quaternion: tuple[float, float, float, float] | None
    velocity: Vector | None
    rotation: Vector | None
    quality: float | None = None
    resets: int = 0


@dataclass(frozen=True, slots=True)
class StatusText:
    """What it told people, and when, in Unix seconds."""

    time: float
    severity: common.MavSeverity | int
    text: str
    component: int
