"""Angles and quaternions of gimbals: degrees in Python, quaternions (w, x, y, z) and radians on the wire.

The order of rotation is yaw, pitch, roll, as for vehicles. Positive pitch is up, positive yaw and roll are to
the right.
"""

from __future__ import annotations

from math import degrees, hypot, isfinite, radians, remainder
from typing import TYPE_CHECKING, TypeAlias

from mavstack.rotation import from_euler, to_euler

if TYPE_CHECKING:
    from collections.abc import Sequence

Quaternion: TypeAlias = tuple[float, float, float, float]


def wrap(angle: float) -> float:
    """Return an angle in degrees within -180 to 180."""
    return remainder(angle, 360.0)


def quaternion_of(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the quaternion of angles in degrees."""
    return from_euler(radians(roll), radians(pitch), radians(yaw))


def angles_of(quaternion: Sequence[float]) -> tuple[float, float, float] | None:
    """Return roll, pitch and yaw in degrees; None if the quaternion is no rotation."""
    w, x, y, z = quaternion
    length = hypot(w, x, y, z)
    if not isfinite(length) or length < 1e-6:
        return None
    angles = to_euler((w / length, x / length, y / length, z / length))
    return degrees(angles[0]), degrees(angles[1]), degrees(angles[2])
