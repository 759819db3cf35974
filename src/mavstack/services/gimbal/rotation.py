"""Angles and quaternions of gimbals: degrees in Python, quaternions (w, x, y, z) and radians on the wire.

The order of rotation is yaw, pitch, roll, as for vehicles. Positive pitch is up, positive yaw and roll are to
the right.
"""

from __future__ import annotations

from math import asin, atan2, cos, degrees, hypot, isfinite, radians, remainder, sin
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Sequence

Quaternion: TypeAlias = tuple[float, float, float, float]


def wrap(angle: float) -> float:
    """Return an angle in degrees within -180 to 180."""
    return remainder(angle, 360.0)


def quaternion_of(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the quaternion of angles in degrees."""
    half_roll, half_pitch, half_yaw = radians(roll) / 2, radians(pitch) / 2, radians(yaw) / 2
    cr, sr, cp, sp = cos(half_roll), sin(half_roll), cos(half_pitch), sin(half_pitch)
    cy, sy = cos(half_yaw), sin(half_yaw)
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def angles_of(quaternion: Sequence[float]) -> tuple[float, float, float] | None:
    """Return roll, pitch and yaw in degrees; None if the quaternion is no rotation."""
    w, x, y, z = quaternion
    length = hypot(w, x, y, z)
    if not isfinite(length) or length < 1e-6:
        return None
    w, x, y, z = w / length, x / length, y / length, z / length
    return (
        degrees(atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))),
        degrees(asin(min(max(2 * (w * y - z * x), -1.0), 1.0))),
        degrees(atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))),
    )
