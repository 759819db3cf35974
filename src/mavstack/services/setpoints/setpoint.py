"""Setpoints as they are meant, and as three messages with type masks (guide: offboard control interface).

A type mask says what a message does *not* control, so a setpoint here has None where it leaves something to
the vehicle, and the mask follows from that. Each axis may be left out alone, though few vehicles take it.

    LocalSetpoint     SET_POSITION_TARGET_LOCAL_NED    metres, in a frame of the ground or the vehicle
    GlobalSetpoint    SET_POSITION_TARGET_GLOBAL_INT   degrees, and metres above what the frame says
    AttitudeSetpoint  SET_ATTITUDE_TARGET              quaternion, body rates, thrust

Global frames are sent by their _INT numbers: PX4 takes no others in this message, ArduPilot takes both.
Reading refuses what no vehicle could follow; the text says why.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.errors import SetpointError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Self

    from mavstack.services.addressing import Address

#: North, east, down, or forward, right, down; None leaves the axis to the vehicle.
Axes: TypeAlias = "tuple[float | None, float | None, float | None]"
#: w, x, y, z.
Quaternion: TypeAlias = tuple[float, float, float, float]

NOTHING: Final[Axes] = (None, None, None)

_F = common.MavFrame
LOCAL_FRAMES: Final = frozenset(
    {_F.LOCAL_NED, _F.LOCAL_OFFSET_NED, _F.BODY_NED, _F.BODY_OFFSET_NED, _F.BODY_FRD, _F.LOCAL_FRD}
)
#: Frames of a global altitude, by the number that is sent.
_SENT_FRAMES: Final[Mapping[int, int]] = MappingProxyType(
    {
        _F.GLOBAL: _F.GLOBAL_INT,
        _F.GLOBAL_RELATIVE_ALT: _F.GLOBAL_RELATIVE_ALT_INT,
        _F.GLOBAL_TERRAIN_ALT: _F.GLOBAL_TERRAIN_ALT_INT,
    }
)
_MEANT_FRAMES: Final[Mapping[int, int]] = MappingProxyType(
    {sent: meant for meant, sent in _SENT_FRAMES.items()} | {meant: meant for meant in _SENT_FRAMES}
)

_FORCE: Final = int(common.PositionTargetTypemask.FORCE_SET)
_YAW: Final = int(common.PositionTargetTypemask.YAW_IGNORE)
_YAW_RATE: Final = int(common.PositionTargetTypemask.YAW_RATE_IGNORE)
_IGNORES_ALL: Final = 0x1FF | _YAW | _YAW_RATE
_THRUST: Final = int(common.AttitudeTargetTypemask.THROTTLE_IGNORE)
_ATTITUDE: Final = int(common.AttitudeTargetTypemask.ATTITUDE_IGNORE)
_THRUST_BODY: Final = int(common.AttitudeTargetTypemask.THRUST_BODY_SET)
_RATES_IGNORED: Final = 0x07
#: How far from 1 the length of a quaternion may be.
_UNIT_TOLERANCE: Final = 0.1
_LARGEST: Final = 3.4028234e38
_LATITUDE, _LONGITUDE = 90.0, 180.0


@dataclass(frozen=True, slots=True)
class LocalSetpoint:
    """Where to be, how fast to go, or how to accelerate, in metres and seconds; yaw in radians.

    With `force` the acceleration is a force in newtons.
    """

    position: Axes = NOTHING
    velocity: Axes = NOTHING
    acceleration: Axes = NOTHING
    yaw: float | None = None
    yaw_rate: float | None = None
    frame: int = common.MavFrame.LOCAL_NED
    force: bool = False

    def check(self) -> None:
        """Raise SetpointError if nothing can follow it."""
        _check_frame(self.frame, LOCAL_FRAMES)
        _check_motion(self, self.position)

    def to_message(self, target: Address, time_boot_ms: int = 0) -> common.SetPositionTargetLocalNed:
        """As SET_POSITION_TARGET_LOCAL_NED."""
        self.check()
        x, y, z = _numbers(self.position)
        vx, vy, vz = _numbers(self.velocity)
        afx, afy, afz = _numbers(self.acceleration)
        return common.SetPositionTargetLocalNed(
            time_boot_ms=time_boot_ms,
            target_system=target.system,
            target_component=target.component,
            coordinate_frame=self.frame,
            type_mask=_mask(self, self.position),
            x=x, y=y, z=z, vx=vx, vy=vy, vz=vz, afx=afx, afy=afy, afz=afz,
            yaw=self.yaw or 0.0,
            yaw_rate=self.yaw_rate or 0.0,
        )  # fmt: skip

    @classmethod
    def read(cls, message: common.SetPositionTargetLocalNed) -> Self:
        """The setpoint in a message; raises SetpointError if nothing can follow it."""
        mask = int(message.type_mask)
        setpoint = cls(
            _axes((message.x, message.y, message.z), mask),
            _axes((message.vx, message.vy, message.vz), mask >> 3),
            _axes((message.afx, message.afy, message.afz), mask >> 6),
            None if mask & _YAW else message.yaw,
            None if mask & _YAW_RATE else message.yaw_rate,
            int(message.coordinate_frame),
            bool(mask & _FORCE),
        )
        setpoint.check()
        return setpoint


@dataclass(frozen=True, slots=True)
class GlobalSetpoint:
    """Where to be in degrees and metres of altitude, with velocity and acceleration in NED.

    `frame` says what the altitude is above: GLOBAL (mean sea level), GLOBAL_RELATIVE_ALT (home) or
    GLOBAL_TERRAIN_ALT.
    """

    latitude: float | None = None
    longitude: float | None = None
    altitude: float | None = None
    velocity: Axes = NOTHING
    acceleration: Axes = NOTHING
    yaw: float | None = None
    yaw_rate: float | None = None
    frame: int = common.MavFrame.GLOBAL_RELATIVE_ALT
    force: bool = False

    @property
    def position(self) -> Axes:
        """Latitude, longitude and altitude."""
        return self.latitude, self.longitude, self.altitude

    def check(self) -> None:
        """Raise SetpointError if nothing can follow it."""
        _check_frame(self.frame, frozenset(_SENT_FRAMES))
        _check_motion(self, self.position)
        if abs(self.latitude or 0.0) > _LATITUDE or abs(self.longitude or 0.0) > _LONGITUDE:
            raise SetpointError(f"{self.latitude}, {self.longitude} is no place on Earth")

    def to_message(self, target: Address, time_boot_ms: int = 0) -> common.SetPositionTargetGlobalInt:
        """As SET_POSITION_TARGET_GLOBAL_INT."""
        self.check()
        vx, vy, vz = _numbers(self.velocity)
        afx, afy, afz = _numbers(self.acceleration)
        return common.SetPositionTargetGlobalInt(
            time_boot_ms=time_boot_ms,
            target_system=target.system,
            target_component=target.component,
            coordinate_frame=_SENT_FRAMES[self.frame],
            type_mask=_mask(self, self.position),
            lat_int=round((self.latitude or 0.0) * 1e7),
            lon_int=round((self.longitude or 0.0) * 1e7),
            alt=self.altitude or 0.0,
            vx=vx, vy=vy, vz=vz, afx=afx, afy=afy, afz=afz,
            yaw=self.yaw or 0.0,
            yaw_rate=self.yaw_rate or 0.0,
        )  # fmt: skip

    @classmethod
    def read(cls, message: common.SetPositionTargetGlobalInt) -> Self:
        """The setpoint in a message; raises SetpointError if nothing can follow it."""
        mask = int(message.type_mask)
        sent = int(message.coordinate_frame)
        setpoint = cls(
            *_axes((message.lat_int / 1e7, message.lon_int / 1e7, message.alt), mask),
            _axes((message.vx, message.vy, message.vz), mask >> 3),
            _axes((message.afx, message.afy, message.afz), mask >> 6),
            None if mask & _YAW else message.yaw,
            None if mask & _YAW_RATE else message.yaw_rate,
            _MEANT_FRAMES.get(sent, sent),
            bool(mask & _FORCE),
        )
        setpoint.check()
        return setpoint


@dataclass(frozen=True, slots=True)
class AttitudeSetpoint:
    """How to be turned, how fast to turn in radians a second, and thrust from -1 to 1.

    `thrust_body` is thrust along three body axes, for vehicles that can; it stands beside `thrust`.
    """

    attitude: Quaternion | None = None
    rates: Axes = NOTHING
    thrust: float | None = None
    thrust_body: tuple[float, float, float] | None = None

    def check(self) -> None:
        """Raise SetpointError if nothing can follow it."""
        if self.attitude is None and self.rates == NOTHING and self.thrust is None and not self.thrust_body:
            raise SetpointError("it controls nothing")
        _check_finite((*self.rates, *(self.attitude or ())))
        thrusts = (self.thrust, *(self.thrust_body or ()))
        if not all(value is None or -1.0 <= value <= 1.0 for value in thrusts):
            raise SetpointError("thrust goes from -1 to 1")
        if self.attitude is not None:
            length = sqrt(sum(value * value for value in self.attitude))
            if abs(length - 1.0) > _UNIT_TOLERANCE:
                raise SetpointError(f"its quaternion has the length {length:.3g}, not 1")

    def to_message(self, target: Address, time_boot_ms: int = 0) -> common.SetAttitudeTarget:
        """As SET_ATTITUDE_TARGET."""
        self.check()
        roll, pitch, yaw = _numbers(self.rates)
        mask = _ignored(self.rates)
        mask |= 0 if self.attitude is not None else _ATTITUDE
        mask |= 0 if self.thrust is not None else _THRUST
        mask |= _THRUST_BODY if self.thrust_body is not None else 0
        return common.SetAttitudeTarget(
            time_boot_ms=time_boot_ms,
            target_system=target.system,
            target_component=target.component,
            type_mask=mask,
            q=self.attitude or (1.0, 0.0, 0.0, 0.0),
            body_roll_rate=roll,
            body_pitch_rate=pitch,
            body_yaw_rate=yaw,
            thrust=self.thrust or 0.0,
            thrust_body=self.thrust_body or (0.0, 0.0, 0.0),
        )

    @classmethod
    def read(cls, message: common.SetAttitudeTarget) -> Self:
        """The setpoint in a message; raises SetpointError if nothing can follow it."""
        mask = int(message.type_mask)
        w, x, y, z = message.q
        forward, right, down = message.thrust_body
        setpoint = cls(
            None if mask & _ATTITUDE else (w, x, y, z),
            _axes((message.body_roll_rate, message.body_pitch_rate, message.body_yaw_rate), mask),
            None if mask & _THRUST else message.thrust,
            (forward, right, down) if mask & _THRUST_BODY else None,
        )
        setpoint.check()
        return setpoint


Setpoint: TypeAlias = LocalSetpoint | GlobalSetpoint | AttitudeSetpoint


def _axes(values: tuple[float, float, float], mask: int) -> Axes:
    x, y, z = (None if mask & 1 << bit else value for bit, value in enumerate(values))
    return x, y, z


def _numbers(axes: Axes) -> tuple[float, float, float]:
    x, y, z = axes
    return x or 0.0, y or 0.0, z or 0.0


def _ignored(axes: Axes) -> int:
    return sum(1 << bit for bit, value in enumerate(axes) if value is None)


def _mask(setpoint: LocalSetpoint | GlobalSetpoint, position: Axes) -> int:
    mask = _ignored(position) | _ignored(setpoint.velocity) << 3 | _ignored(setpoint.acceleration) << 6
    mask |= 0 if setpoint.yaw is not None else _YAW
    mask |= 0 if setpoint.yaw_rate is not None else _YAW_RATE
    return mask | (_FORCE if setpoint.force else 0)


def _check_frame(frame: int, known: frozenset[int]) -> None:
    if frame not in known:
        raise SetpointError(f"frame {int(frame)} is not one that this message can have")


def _check_motion(setpoint: LocalSetpoint | GlobalSetpoint, position: Axes) -> None:
    if _mask(setpoint, position) & _IGNORES_ALL == _IGNORES_ALL:
        raise SetpointError("it controls nothing")
    _check_finite((*position, *setpoint.velocity, *setpoint.acceleration, setpoint.yaw, setpoint.yaw_rate))


def _check_finite(values: Sequence[float | None]) -> None:
    if not all(value is None or abs(value) <= _LARGEST for value in values):
        raise SetpointError("a number in it is not finite")
