"""Setpoints, and the three messages with type masks that carry them (guide: offboard control interface).

A type mask says what a message does *not* control: a setpoint has None where it leaves an axis to the
vehicle, and the mask follows from that. Each axis may be None alone, though few vehicles accept it.

    LocalSetpoint     SET_POSITION_TARGET_LOCAL_NED    metres, in a frame of the ground or the vehicle
    GlobalSetpoint    SET_POSITION_TARGET_GLOBAL_INT   degrees, and metres above the frame's reference
    AttitudeSetpoint  SET_ATTITUDE_TARGET              quaternion, body rates, thrust

Global frames are sent by their _INT numbers: PX4 accepts no others in this message, ArduPilot accepts both.
Reading refuses setpoints that no vehicle could follow.
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

#: The components north, east, down or forward, right, down; None: the vehicle decides about that axis.
Axes: TypeAlias = "tuple[float | None, float | None, float | None]"
#: The components w, x, y, z.
Quaternion: TypeAlias = tuple[float, float, float, float]

NOTHING: Final[Axes] = (None, None, None)

_F = common.MavFrame
LOCAL_FRAMES: Final = frozenset(
    {_F.LOCAL_NED, _F.LOCAL_OFFSET_NED, _F.BODY_NED, _F.BODY_OFFSET_NED, _F.BODY_FRD, _F.LOCAL_FRD}
)
#: The global frames, each with the frame that is sent for it.
_SENT_FRAMES: Final[Mapping[int, int]] = MappingProxyType(
    {
        _F.GLOBAL: _F.GLOBAL_INT,
        _F.GLOBAL_RELATIVE_ALT: _F.GLOBAL_RELATIVE_ALT_INT,
        _F.GLOBAL_TERRAIN_ALT: _F.GLOBAL_TERRAIN_ALT_INT,
    }
)
_FRAMES_OF_SENT: Final[Mapping[int, int]] = MappingProxyType(
    {sent: frame for frame, sent in _SENT_FRAMES.items()} | {frame: frame for frame in _SENT_FRAMES}
)

_FORCE: Final = int(common.PositionTargetTypemask.FORCE_SET)
_YAW: Final = int(common.PositionTargetTypemask.YAW_IGNORE)
_YAW_RATE: Final = int(common.PositionTargetTypemask.YAW_RATE_IGNORE)
_IGNORES_ALL: Final = 0x1FF | _YAW | _YAW_RATE
_THRUST: Final = int(common.AttitudeTargetTypemask.THROTTLE_IGNORE)
_ATTITUDE: Final = int(common.AttitudeTargetTypemask.ATTITUDE_IGNORE)
_THRUST_BODY: Final = int(common.AttitudeTargetTypemask.THRUST_BODY_SET)
_RATES_IGNORED: Final = 0x07
#: The largest deviation of the length of a quaternion from 1.
_UNIT_TOLERANCE: Final = 0.1
_MAX_VALUE: Final = 3.4028234e38
_LATITUDE, _LONGITUDE = 90.0, 180.0


@dataclass(frozen=True, slots=True)
class LocalSetpoint:
    """A position, velocity or acceleration in a local frame.

    Attributes:
        position: North, east, down in metres; None leaves the axis to the vehicle.
        velocity: North, east, down in m/s.
        acceleration: North, east, down in m/s², or a force in newtons with `force`.
        yaw: The heading in radians.
        yaw_rate: The yaw rate in rad/s.
        frame: The MAV_FRAME, one of `LOCAL_FRAMES`.
        force: True if `acceleration` is a force.
    """

    position: Axes = NOTHING
    velocity: Axes = NOTHING
    acceleration: Axes = NOTHING
    yaw: float | None = None
    yaw_rate: float | None = None
    frame: int = common.MavFrame.LOCAL_NED
    force: bool = False

    def check(self) -> None:
        """Raise SetpointError if no vehicle can follow the setpoint."""
        _check_frame(self.frame, LOCAL_FRAMES)
        _check_motion(self, self.position)

    def to_message(self, target: Address, time_boot_ms: int = 0) -> common.SetPositionTargetLocalNed:
        """Return the SET_POSITION_TARGET_LOCAL_NED."""
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
        """Return the setpoint in a message; raises SetpointError if no vehicle can follow it."""
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
    """A global position, with velocity and acceleration in NED.

    Attributes:
        latitude: Degrees; None leaves it to the vehicle.
        longitude: Degrees.
        altitude: Metres above the reference of `frame`.
        velocity: North, east, down in m/s.
        acceleration: North, east, down in m/s², or a force in newtons with `force`.
        yaw: The heading in radians.
        yaw_rate: The yaw rate in rad/s.
        frame: GLOBAL (above mean sea level), GLOBAL_RELATIVE_ALT (home) or GLOBAL_TERRAIN_ALT.
        force: True if `acceleration` is a force.
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
        """Raise SetpointError if no vehicle can follow the setpoint."""
        _check_frame(self.frame, frozenset(_SENT_FRAMES))
        _check_motion(self, self.position)
        if abs(self.latitude or 0.0) > _LATITUDE or abs(self.longitude or 0.0) > _LONGITUDE:
            raise SetpointError(
                f"latitude must be within 90 and longitude within 180 degrees, "
                f"got {self.latitude}, {self.longitude}"
            )

    def to_message(self, target: Address, time_boot_ms: int = 0) -> common.SetPositionTargetGlobalInt:
        """Return the SET_POSITION_TARGET_GLOBAL_INT."""
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
        """Return the setpoint in a message; raises SetpointError if no vehicle can follow it."""
        mask = int(message.type_mask)
        sent = int(message.coordinate_frame)
        setpoint = cls(
            *_axes((message.lat_int / 1e7, message.lon_int / 1e7, message.alt), mask),
            _axes((message.vx, message.vy, message.vz), mask >> 3),
            _axes((message.afx, message.afy, message.afz), mask >> 6),
            None if mask & _YAW else message.yaw,
            None if mask & _YAW_RATE else message.yaw_rate,
            _FRAMES_OF_SENT.get(sent, sent),
            bool(mask & _FORCE),
        )
        setpoint.check()
        return setpoint


@dataclass(frozen=True, slots=True)
class AttitudeSetpoint:
    """An attitude, body rates and thrust.

    Attributes:
        attitude: The quaternion w, x, y, z from NED to the body frame; None leaves it to the vehicle.
        rates: Roll, pitch and yaw rate of the body in rad/s.
        thrust: The collective thrust, -1 to 1.
        thrust_body: The thrust along the three body axes, -1 to 1, for vehicles that support it.
    """

    attitude: Quaternion | None = None
    rates: Axes = NOTHING
    thrust: float | None = None
    thrust_body: tuple[float, float, float] | None = None

    def check(self) -> None:
        """Raise SetpointError if no vehicle can follow the setpoint."""
        if self.attitude is None and self.rates == NOTHING and self.thrust is None and not self.thrust_body:
            raise SetpointError("a setpoint must control at least one value")
        _check_finite((*self.rates, *(self.attitude or ())))
        thrusts = (self.thrust, *(self.thrust_body or ()))
        if not all(value is None or -1.0 <= value <= 1.0 for value in thrusts):
            raise SetpointError("thrust must be from -1 to 1")
        if self.attitude is not None:
            length = sqrt(sum(value * value for value in self.attitude))
            if abs(length - 1.0) > _UNIT_TOLERANCE:
                raise SetpointError(f"the attitude must be a unit quaternion, got length {length:.3g}")

    def to_message(self, target: Address, time_boot_ms: int = 0) -> common.SetAttitudeTarget:
        """Return the SET_ATTITUDE_TARGET."""
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
        """Return the setpoint in a message; raises SetpointError if no vehicle can follow it."""
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
        raise SetpointError(f"frame {int(frame)} is not supported by this setpoint")


def _check_motion(setpoint: LocalSetpoint | GlobalSetpoint, position: Axes) -> None:
    if _mask(setpoint, position) & _IGNORES_ALL == _IGNORES_ALL:
        raise SetpointError("a setpoint must control at least one value")
    _check_finite((*position, *setpoint.velocity, *setpoint.acceleration, setpoint.yaw, setpoint.yaw_rate))


def _check_finite(values: Sequence[float | None]) -> None:
    if not all(value is None or abs(value) <= _MAX_VALUE for value in values):
        raise SetpointError("all values of a setpoint must be finite")
