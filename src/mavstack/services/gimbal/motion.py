"""The motion of a stabilising gimbal: the setpoint is reached at a limited rate, within a range.

Pitch and roll are kept relative to the horizon. Yaw follows the vehicle's nose, or with `yaw_lock` keeps its
direction while the vehicle turns, as far as the range of the yaw axis allows. The class serves simulated
gimbals, and gimbals whose electronics report no attitude.
"""

from __future__ import annotations

from math import inf, isfinite
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.gimbal.reports import GimbalAttitude, GimbalInformation
from mavstack.services.gimbal.rotation import wrap
from mavstack.services.gimbal.setpoint import GimbalSetpoint

if TYPE_CHECKING:
    from mavstack.services.gimbal.setpoint import GimbalValue

#: The default of the maximum rate, in degrees per second.
DEFAULT_MAX_RATE = 60.0

_FLAGS, _ERRORS = common.GimbalDeviceFlags, common.GimbalDeviceErrorFlags
_HORIZON = int(_FLAGS.ROLL_LOCK | _FLAGS.PITCH_LOCK)


class _Axis:
    """One axis: its angle and the commanded angle or rate, in degrees and degrees per second."""

    def __init__(self, limits: tuple[float, float], *, endless: bool = False) -> None:
        self.limits = limits
        self.angle = min(max(0.0, limits[0]), limits[1])
        self.target: float | None = None
        self.rate: float | None = None
        self.speed = 0.0
        self._endless = endless

    @property
    def at_limit(self) -> bool:
        """True if the axis cannot go on in the direction that it shall turn to."""
        return not self._endless and self.target is not None and self.clipped(self.target) != self.target

    def clipped(self, angle: float) -> float:
        """Return an angle within the range of the axis."""
        return angle if self._endless else min(max(angle, self.limits[0]), self.limits[1])

    def command(self, target: float | None, rate: float | None) -> None:
        """Turn to an angle, or at a rate; two times None keep the present command."""
        if target is not None or rate is not None:
            self.target, self.rate = target, rate

    def advance(self, seconds: float, max_rate: float) -> None:
        """Turn for some seconds."""
        before = self.angle
        if self.target is not None:
            limit = max_rate if not self.rate else min(abs(self.rate), max_rate)
            way = self.clipped(self.target) - self.angle
            if self._endless:
                way = wrap(way)
            self.angle += min(max(way, -limit * seconds), limit * seconds)
        elif self.rate is not None:
            self.angle = self.clipped(self.angle + min(max(self.rate, -max_rate), max_rate) * seconds)
        self.speed = (self.angle - before) / seconds if seconds > 0 else 0.0
        if self._endless:
            self.angle = wrap(self.angle)


class GimbalMotion:
    """The motion of one gimbal; time is an argument.

    Args:
        information: The gimbal, with the ranges of its axes.
        max_rate: The largest angular rate of each axis, degrees per second.
    """

    def __init__(
        self, information: GimbalInformation | None = None, *, max_rate: float = DEFAULT_MAX_RATE
    ) -> None:
        self.information = information or GimbalInformation()
        self.max_rate = max_rate
        endless = self.information.can(common.GimbalManagerCapFlags.SUPPORTS_INFINITE_YAW)
        self._roll = _Axis(self.information.roll_range)
        self._pitch = _Axis(self.information.pitch_range)
        #: Relative to the vehicle, also while yaw is locked, because the range is a mechanical limit.
        self._yaw = _Axis(self.information.yaw_range, endless=endless or self._is_full_circle())
        self._lock = False
        self._retracted = self._neutral = False
        #: The direction that is kept while yaw is locked, in degrees from north.
        self._heading: float | None = None
        self._vehicle_heading: float | None = None
        self._moved_at = -inf

    def apply(self, value: GimbalValue, now: float) -> None:
        """Follow a setpoint from now on."""
        setpoint = value if isinstance(value, GimbalSetpoint) else self._setpoint_of_sticks(value)
        self._retracted, self._neutral = setpoint.retract, setpoint.neutral and not setpoint.retract
        if setpoint.retract or setpoint.neutral:
            self._lock, self._heading = False, None
            for axis in (self._roll, self._pitch, self._yaw):
                axis.command(0.0, None)
            return
        self._roll.command(_finite(setpoint.roll), _finite(setpoint.roll_rate))
        self._pitch.command(_finite(setpoint.pitch), _finite(setpoint.pitch_rate))
        self._command_yaw(setpoint)

    def advance(self, now: float, vehicle_heading: float | None) -> GimbalAttitude:
        """Turn until `now` and return the attitude.

        Args:
            now: Unix seconds.
            vehicle_heading: Degrees from north; None if unknown.

        Returns:
            The attitude.
        """
        seconds = min(max(now - self._moved_at, 0.0), 1.0) if isfinite(self._moved_at) else 0.0
        self._moved_at = now
        self._turn_with_vehicle(vehicle_heading)
        for axis in (self._roll, self._pitch, self._yaw):
            axis.advance(seconds, self.max_rate)
        if self._lock and self._yaw.target is None and vehicle_heading is not None:
            # a yaw rate turns the direction that is kept
            self._heading = wrap(self._yaw.angle + vehicle_heading)
        return self._attitude(vehicle_heading)

    def _command_yaw(self, setpoint: GimbalSetpoint) -> None:
        yaw, rate = _finite(setpoint.yaw), _finite(setpoint.yaw_rate)
        vehicle = self._vehicle_heading
        self._lock = setpoint.yaw_lock
        relative = yaw
        if yaw is not None and setpoint.yaw_in_earth_frame and vehicle is not None:
            relative = wrap(yaw - vehicle)
        self._yaw.command(relative, rate)
        target = self._yaw.angle if self._yaw.target is None else self._yaw.target
        self._heading = wrap(target + vehicle) if self._lock and vehicle is not None else None
        if self._lock and vehicle is None and setpoint.yaw_in_earth_frame:
            self._heading = yaw

    def _turn_with_vehicle(self, vehicle_heading: float | None) -> None:
        """Counteract a turn of the vehicle while yaw is locked."""
        before, self._vehicle_heading = self._vehicle_heading, vehicle_heading
        if not self._lock or vehicle_heading is None:
            return
        if before is not None:
            self._yaw.angle = self._yaw.clipped(wrap(self._yaw.angle - wrap(vehicle_heading - before)))
        if self._heading is not None and (self._yaw.target is not None or self._yaw.rate is None):
            self._yaw.target = wrap(self._heading - vehicle_heading)

    def _setpoint_of_sticks(self, sticks: GimbalValue) -> GimbalSetpoint:
        """Scale stick positions: the ends are the ends of the range, or half of the largest rate."""

        def angle(stick: float | None, limits: tuple[float, float]) -> float | None:
            return None if stick is None else stick * (limits[1] if stick > 0 else -limits[0])

        def rate(stick: float | None) -> float | None:
            return None if stick is None else stick * self.max_rate / 2

        return GimbalSetpoint(
            pitch=angle(sticks.pitch, self.information.pitch_range),
            yaw=angle(sticks.yaw, self.information.yaw_range),
            pitch_rate=rate(sticks.pitch_rate),
            yaw_rate=rate(sticks.yaw_rate),
            yaw_lock=sticks.yaw_lock,
            flags=int(common.GimbalManagerFlags.YAW_IN_VEHICLE_FRAME),
        )

    def _attitude(self, vehicle_heading: float | None) -> GimbalAttitude:
        yaw = wrap(self._yaw.angle)
        flags = _HORIZON | int(_FLAGS.ACCEPTS_YAW_IN_EARTH_FRAME)
        flags |= int(_FLAGS.YAW_LOCK) if self._lock else 0
        flags |= int(_FLAGS.RETRACT) if self._retracted else int(_FLAGS.NEUTRAL) if self._neutral else 0
        failures = int(_ERRORS.AT_ROLL_LIMIT) if self._roll.at_limit else 0
        failures |= int(_ERRORS.AT_PITCH_LIMIT) if self._pitch.at_limit else 0
        failures |= int(_ERRORS.AT_YAW_LIMIT) if self._yaw.at_limit else 0
        return GimbalAttitude(
            self._roll.angle,
            self._pitch.angle,
            yaw,
            None if vehicle_heading is None else wrap(yaw + vehicle_heading),
            self._roll.speed,
            self._pitch.speed,
            self._yaw.speed,
            flags,
            failures,
        )

    def _is_full_circle(self) -> bool:
        first, last = self.information.yaw_range
        return last - first >= 360.0


def _finite(value: float | None) -> float | None:
    """Return a value of a setpoint from outside, without infinities and NaN."""
    return value if value is not None and isfinite(value) else None
