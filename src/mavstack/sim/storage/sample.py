"""Input of a vehicle's logger: one sample of a flight, and the facts at the start of a log."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.services.mission import MissionItem
    from mavstack.services.parameters import Value
    from mavstack.sim.motion.readings import EstimateHealth, Motion, SensorReadings

_EMPTY: tuple[int, ...] = ()
_NAN = float("nan")


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


class FlightSample(NamedTuple):
    """One sample: microseconds since boot, estimated position in degrees and metres AMSL."""

    time_us: int
    motion: Motion
    sensors: SensorReadings
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
    #: Altitude of home in metres above mean sea level.
    home_altitude: float = 0.0
    #: Attitude setpoints in radians; NaN without a setpoint.
    desired_roll: float = _NAN
    desired_pitch: float = _NAN
    desired_yaw: float = _NAN
    health: EstimateHealth | None = None


class LoggedParameter(NamedTuple):
    """A logged parameter; an int is an integer parameter."""

    name: str
    value: Value
    default: Value | None = None


@dataclass(frozen=True, slots=True)
class LogStart:
    """Facts at the start of a log; `boot` is the Unix time in seconds of `time_us` 0."""

    boot: float = 0.0
    #: Version text of the firmware, such as "ArduCopter V4.6.0 (1f2e3d4c)".
    firmware: str = ""
    version: tuple[int, int, int] = (0, 0, 0)
    git_hash: str = "00000000"
    board: str = "SITL"
    system: int = 1
    #: MAV_TYPE.
    vehicle: int = 0
    parameters: Sequence[LoggedParameter] = ()
    mission: Sequence[MissionItem] = ()
    #: Latitude and longitude in degrees and altitude in metres above mean sea level: of the estimator's
    #: origin, and of home if it is set.
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    home: tuple[float, float, float] | None = None
    mode: int = 0
