"""Input of a vehicle's logger: one sample of a flight, and the facts at the start of a log.

The parts of a sample are Protocols, so that any physics and any autopilot can be logged.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.services.mission import MissionItem
    from mavstack.services.parameters import Value

_EMPTY: tuple[int, ...] = ()
_NAN = float("nan")


class MotionLike(Protocol):
    """An estimated motion: metres, m/s and m/s2 in local north-east-down; radians and rad/s."""

    @property
    def north(self) -> float: ...
    @property
    def east(self) -> float: ...
    @property
    def down(self) -> float: ...
    @property
    def velocity_north(self) -> float: ...
    @property
    def velocity_east(self) -> float: ...
    @property
    def velocity_down(self) -> float: ...
    @property
    def acceleration_north(self) -> float: ...
    @property
    def acceleration_east(self) -> float: ...
    @property
    def acceleration_down(self) -> float: ...
    @property
    def roll(self) -> float: ...
    @property
    def pitch(self) -> float: ...
    @property
    def yaw(self) -> float: ...
    @property
    def roll_rate(self) -> float: ...
    @property
    def pitch_rate(self) -> float: ...
    @property
    def yaw_rate(self) -> float: ...


class SensorsLike(Protocol):
    """Sensor readings: rad/s, m/s2 (specific force), gauss, hPa, degrees Celsius; GPS in degrees and m/s."""

    @property
    def gyro_x(self) -> float: ...
    @property
    def gyro_y(self) -> float: ...
    @property
    def gyro_z(self) -> float: ...
    @property
    def acceleration_x(self) -> float: ...
    @property
    def acceleration_y(self) -> float: ...
    @property
    def acceleration_z(self) -> float: ...
    @property
    def magnetic_x(self) -> float: ...
    @property
    def magnetic_y(self) -> float: ...
    @property
    def magnetic_z(self) -> float: ...
    @property
    def pressure(self) -> float: ...
    @property
    def differential_pressure(self) -> float: ...
    @property
    def temperature(self) -> float: ...
    @property
    def gps_latitude(self) -> float: ...
    @property
    def gps_longitude(self) -> float: ...
    @property
    def gps_altitude(self) -> float: ...
    @property
    def gps_velocity_north(self) -> float: ...
    @property
    def gps_velocity_east(self) -> float: ...
    @property
    def gps_velocity_down(self) -> float: ...
    @property
    def gps_fix(self) -> int: ...
    @property
    def gps_satellites(self) -> int: ...
    @property
    def gps_eph(self) -> float: ...
    @property
    def gps_epv(self) -> float: ...
    @property
    def distance(self) -> float: ...


class BatteryLike(Protocol):
    """Volts, amperes, consumed mAh, state of charge 0..1, degrees Celsius."""

    @property
    def voltage(self) -> float: ...
    @property
    def current(self) -> float: ...
    @property
    def consumed(self) -> float: ...
    @property
    def remaining(self) -> float: ...
    @property
    def temperature(self) -> float: ...
    @property
    def cells(self) -> float: ...


class HealthLike(Protocol):
    """Validity and test ratios of the estimate."""

    @property
    def horizontal(self) -> bool: ...
    @property
    def vertical(self) -> bool: ...
    @property
    def velocity_variance(self) -> float: ...
    @property
    def position_variance(self) -> float: ...
    @property
    def height_variance(self) -> float: ...
    @property
    def compass_variance(self) -> float: ...


class FlightSample(NamedTuple):
    """One sample: microseconds since boot, estimated position in degrees and metres AMSL."""

    time_us: int
    motion: MotionLike
    sensors: SensorsLike
    battery: BatteryLike
    latitude: float
    longitude: float
    altitude: float
    #: HEARTBEAT's `custom_mode`.
    mode: int = 0
    armed: bool = False
    landed: bool = True
    failsafe: bool = False
    #: Pulse widths in microseconds; empty without a receiver.
    rc: Sequence[float] = _EMPTY
    servos: Sequence[float] = _EMPTY
    mission_sequence: int = 0
    mission_total: int = 0
    #: Sequence number of the last reached item; -1 before the first.
    mission_reached: int = -1
    airspeed: float = 0.0
    #: Altitude of home in metres AMSL.
    home_altitude: float = 0.0
    #: Attitude setpoints in radians; NaN if there is none.
    desired_roll: float = _NAN
    desired_pitch: float = _NAN
    desired_yaw: float = _NAN
    health: HealthLike | None = None


class LoggedParameter(NamedTuple):
    """A logged parameter; an int is an integer parameter."""

    name: str
    value: Value
    default: Value | None = None


@dataclass(frozen=True, slots=True)
class LogStart:
    """Facts at the start of a log; `boot` is the Unix time in seconds of `time_us` 0."""

    boot: float = 0.0
    #: Banner of the firmware: "ArduCopter V4.6.0 (1f2e3d4c)".
    firmware: str = ""
    version: tuple[int, int, int] = (0, 0, 0)
    git_hash: str = "00000000"
    board: str = "SITL"
    system: int = 1
    #: MAV_TYPE.
    vehicle: int = 0
    parameters: Sequence[LoggedParameter] = ()
    mission: Sequence[MissionItem] = ()
    #: Latitude, longitude (degrees) and altitude AMSL of the estimate's origin, and of home if it is set.
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    home: tuple[float, float, float] | None = None
    mode: int = 0
