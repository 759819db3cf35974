"""Setpoints of a gimbal: angles, angular rates or stick positions, as commands and as messages.

A value of None leaves an axis to its rate, or unchanged. An angle together with a rate is reached at that
rate. Yaw is relative to the vehicle's nose, and follows it, unless `yaw_lock` is set: then it is relative to
north and stays there.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, isnan, nan, radians
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.arguments import check_number
from mavstack.services.command import Command
from mavstack.services.gimbal.reports import frame_of
from mavstack.services.gimbal.rotation import angles_of, quaternion_of

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Self

    from mavstack.services.addressing import Address

_FLAGS = common.GimbalManagerFlags
#: The flags of a stabilising gimbal, which keeps roll and pitch relative to the horizon.
_HORIZON = _FLAGS.ROLL_LOCK | _FLAGS.PITCH_LOCK
MAX_ANGLE = 180.0


@dataclass(frozen=True, slots=True)
class GimbalSetpoint:
    """Where a gimbal shall point, and how fast it shall turn.

    Attributes:
        pitch: Degrees above the horizon, -180 to 180; None: not set.
        yaw: Degrees to the right of the nose, or of north with `yaw_lock`, -180 to 180; None: not set.
        roll: Degrees, -180 to 180; None: not set. Only GIMBAL_MANAGER_SET_ATTITUDE carries roll.
        pitch_rate: Degrees per second, positive up; None: not set.
        yaw_rate: Degrees per second, positive to the right; None: not set.
        roll_rate: Degrees per second, positive to the right; None: not set.
        yaw_lock: True: yaw is relative to north and does not follow the vehicle.
        retract: True: go to the safe, retracted position; the other values are ignored.
        neutral: True: go to the neutral position; the other values are ignored.
        flags: Further GIMBAL_MANAGER_FLAGS, such as RC_MIXED.
    """

    pitch: float | None = None
    yaw: float | None = None
    roll: float | None = None
    pitch_rate: float | None = None
    yaw_rate: float | None = None
    roll_rate: float | None = None
    yaw_lock: bool = False
    retract: bool = False
    neutral: bool = False
    flags: int = 0

    def check(self) -> None:
        """Raise unless a gimbal could follow the setpoint.

        Raises:
            InvalidTypeError: A value is not a number.
            InvalidArgumentError: A value is not finite, an angle is out of range, or nothing is set.
        """
        angles = {"pitch": self.pitch, "yaw": self.yaw, "roll": self.roll}
        rates = {"pitch_rate": self.pitch_rate, "yaw_rate": self.yaw_rate, "roll_rate": self.roll_rate}
        _check_values(angles | rates)
        for name, angle in angles.items():
            if angle is not None and abs(angle) > MAX_ANGLE:
                raise InvalidArgumentError(f"{name} must be from -180 to 180 degrees, got {angle:g}")
        if not (self.retract or self.neutral) and all(
            each is None for each in (*angles.values(), *rates.values())
        ):
            raise InvalidArgumentError("a gimbal setpoint needs an angle, a rate, retract or neutral")

    @property
    def manager_flags(self) -> int:
        """The GIMBAL_MANAGER_FLAGS of the setpoint."""
        lock = _FLAGS.YAW_LOCK if self.yaw_lock else 0
        special = (_FLAGS.RETRACT if self.retract else 0) | (_FLAGS.NEUTRAL if self.neutral else 0)
        return int(self.flags | _HORIZON | lock | special)

    def to_command(self, device_id: int) -> Command:
        """Return DO_GIMBAL_MANAGER_PITCHYAW, which is acknowledged.

        Raises:
            InvalidArgumentError: Roll is set, which the command cannot carry.
        """
        if self.roll is not None or self.roll_rate is not None:
            raise InvalidArgumentError("DO_GIMBAL_MANAGER_PITCHYAW has no roll; stream the setpoint")
        return Command(
            common.MavCmd.DO_GIMBAL_MANAGER_PITCHYAW,
            _or_nan(self.pitch),
            _or_nan(self.yaw),
            _or_nan(self.pitch_rate),
            _or_nan(self.yaw_rate),
            float(self.manager_flags),
            0.0,
            float(device_id),
        )

    @classmethod
    def from_command(cls, command: Command) -> Self:
        """Return the setpoint of a DO_GIMBAL_MANAGER_PITCHYAW."""
        flags = command.param5
        return cls._of(
            int(flags) if 0 <= flags <= 0xFFFFFFFF else 0,
            pitch=_known(command.param1),
            yaw=_known(command.param2),
            pitch_rate=_known(command.param3),
            yaw_rate=_known(command.param4),
        )

    def to_message(
        self, target: Address, device_id: int
    ) -> common.GimbalManagerSetPitchyaw | common.GimbalManagerSetAttitude:
        """Return GIMBAL_MANAGER_SET_PITCHYAW, or GIMBAL_MANAGER_SET_ATTITUDE if roll is set."""
        if self.roll is None and self.roll_rate is None:
            return common.GimbalManagerSetPitchyaw(
                target_system=target.system,
                target_component=target.component,
                flags=self.manager_flags,
                gimbal_device_id=device_id,
                pitch=_radians(self.pitch),
                yaw=_radians(self.yaw),
                pitch_rate=_radians(self.pitch_rate),
                yaw_rate=_radians(self.yaw_rate),
            )
        angles = (self.roll, self.pitch, self.yaw)
        known = any(angle is not None for angle in angles)
        return common.GimbalManagerSetAttitude(
            target_system=target.system,
            target_component=target.component,
            flags=self.manager_flags,
            gimbal_device_id=device_id,
            q=quaternion_of(*(angle or 0.0 for angle in angles)) if known else (nan, nan, nan, nan),
            angular_velocity_x=_radians(self.roll_rate),
            angular_velocity_y=_radians(self.pitch_rate),
            angular_velocity_z=_radians(self.yaw_rate),
        )

    @classmethod
    def from_message(cls, message: common.GimbalManagerSetPitchyaw | common.GimbalManagerSetAttitude) -> Self:
        """Return the setpoint of either message."""
        flags = int(message.flags)
        if isinstance(message, common.GimbalManagerSetPitchyaw):
            return cls._of(
                flags,
                pitch=_degrees(message.pitch),
                yaw=_degrees(message.yaw),
                pitch_rate=_degrees(message.pitch_rate),
                yaw_rate=_degrees(message.yaw_rate),
            )
        roll, pitch, yaw = angles_of(message.q) or (None, None, None)
        return cls._of(
            flags,
            pitch=pitch,
            yaw=yaw,
            roll=roll,
            roll_rate=_degrees(message.angular_velocity_x),
            pitch_rate=_degrees(message.angular_velocity_y),
            yaw_rate=_degrees(message.angular_velocity_z),
        )

    @property
    def yaw_in_earth_frame(self) -> bool:
        """True if yaw is relative to north, as the flags of the setpoint say."""
        return frame_of(self.manager_flags)[0]

    @classmethod
    def _of(cls, flags: int, **values: float | None) -> Self:
        own = _HORIZON | _FLAGS.YAW_LOCK | _FLAGS.RETRACT | _FLAGS.NEUTRAL
        return cls(
            **values,
            yaw_lock=bool(flags & _FLAGS.YAW_LOCK),
            retract=bool(flags & _FLAGS.RETRACT),
            neutral=bool(flags & _FLAGS.NEUTRAL),
            flags=flags & ~int(own),
        )


@dataclass(frozen=True, slots=True)
class GimbalSticks:
    """Stick positions for a gimbal (GIMBAL_MANAGER_SET_MANUAL_CONTROL), each from -1 to 1.

    The gimbal manager turns them into angles or rates by its own settings.

    Attributes:
        pitch: Angle; None: not set.
        yaw: Angle; None: not set.
        pitch_rate: Rate, positive up; None: not set.
        yaw_rate: Rate, positive to the right; None: not set.
        yaw_lock: True: yaw does not follow the vehicle.
    """

    pitch: float | None = None
    yaw: float | None = None
    pitch_rate: float | None = None
    yaw_rate: float | None = None
    yaw_lock: bool = False

    def check(self) -> None:
        """Raise unless all values are from -1 to 1.

        Raises:
            InvalidTypeError: A value is not a number.
            InvalidArgumentError: A value is out of range.
        """
        sticks = {
            "pitch": self.pitch,
            "yaw": self.yaw,
            "pitch_rate": self.pitch_rate,
            "yaw_rate": self.yaw_rate,
        }
        _check_values(sticks)
        for name, value in sticks.items():
            if value is not None and abs(value) > 1.0:
                raise InvalidArgumentError(f"the stick {name} must be from -1 to 1, got {value:g}")

    def to_message(self, target: Address, device_id: int) -> common.GimbalManagerSetManualControl:
        """Return GIMBAL_MANAGER_SET_MANUAL_CONTROL."""
        return common.GimbalManagerSetManualControl(
            target_system=target.system,
            target_component=target.component,
            flags=int(_HORIZON | (_FLAGS.YAW_LOCK if self.yaw_lock else 0)),
            gimbal_device_id=device_id,
            pitch=_or_nan(self.pitch),
            yaw=_or_nan(self.yaw),
            pitch_rate=_or_nan(self.pitch_rate),
            yaw_rate=_or_nan(self.yaw_rate),
        )

    @classmethod
    def from_message(cls, message: common.GimbalManagerSetManualControl) -> Self:
        """Return the stick positions of a message, limited to -1 to 1."""
        return cls(
            _stick(message.pitch),
            _stick(message.yaw),
            _stick(message.pitch_rate),
            _stick(message.yaw_rate),
            bool(message.flags & _FLAGS.YAW_LOCK),
        )


#: The values that can be streamed to a gimbal.
GimbalValue: TypeAlias = GimbalSetpoint | GimbalSticks


def _check_values(values: Mapping[str, float | None]) -> None:
    for name, value in values.items():
        if value is not None:
            check_number(name, value)


def _or_nan(value: float | None) -> float:
    return nan if value is None else float(value)


def _stick(value: float) -> float | None:
    return None if isnan(value) else min(max(value, -1.0), 1.0)


def _known(value: float) -> float | None:
    return None if isnan(value) else value


def _radians(value: float | None) -> float:
    return nan if value is None else radians(value)


def _degrees(value: float) -> float | None:
    return None if isnan(value) else degrees(value)
