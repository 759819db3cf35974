"""Rotations by unit quaternions (w, x, y, z), which turn vectors of a body into those of the world.

MAVLink has (w, x, y, z) too; its bodies have the axes forward, right, down, its world north, east, down. The
order of three angles is yaw, pitch, roll. Plain floats: for one body they are faster than arrays.
"""

from __future__ import annotations

import math
from typing import TypeAlias

Vector: TypeAlias = tuple[float, float, float]
Quaternion: TypeAlias = tuple[float, float, float, float]

LEVEL: Quaternion = (1.0, 0.0, 0.0, 0.0)


def rotate(quaternion: Quaternion, vector: Vector) -> Vector:
    """Return a vector of the body in the world."""
    w, x, y, z = quaternion
    a, b, c = vector
    # t = 2 (q x v); v' = v + w t + q x t
    ta, tb, tc = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return (
        a + w * ta + y * tc - z * tb,
        b + w * tb + z * ta - x * tc,
        c + w * tc + x * tb - y * ta,
    )


def rotate_back(quaternion: Quaternion, vector: Vector) -> Vector:
    """Return a vector of the world in the body."""
    w, x, y, z = quaternion
    return rotate((w, -x, -y, -z), vector)


def multiply(one: Quaternion, other: Quaternion) -> Quaternion:
    """Return the product of two quaternions: the rotation `other`, then `one`."""
    a, b, c, d = one
    w, x, y, z = other
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def turned(quaternion: Quaternion, rates: Vector, dt: float) -> Quaternion:
    """Return the attitude after a turn at constant body rates.

    Args:
        quaternion: The attitude before.
        rates: Body rates in rad/s.
        dt: Seconds.

    Returns:
        The attitude, of unit length.
    """
    p, q, r = rates
    rate = math.sqrt(p * p + q * q + r * r)
    if rate * dt < 1e-12:
        return quaternion
    half = 0.5 * rate * dt
    scale = math.sin(half) / rate
    ow, ox, oy, oz = multiply(quaternion, (math.cos(half), p * scale, q * scale, r * scale))
    length = 1.0 / math.sqrt(ow * ow + ox * ox + oy * oy + oz * oz)
    return ow * length, ox * length, oy * length, oz * length


def from_euler(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the attitude of three angles in radians, turned in the order yaw, pitch, roll."""
    cos, sin = math.cos, math.sin
    roll, pitch, yaw = 0.5 * roll, 0.5 * pitch, 0.5 * yaw
    cr, sr, cp, sp, cy, sy = cos(roll), sin(roll), cos(pitch), sin(pitch), cos(yaw), sin(yaw)
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def to_euler(quaternion: Quaternion) -> Vector:
    """Return roll, pitch and yaw in radians."""
    w, x, y, z = quaternion
    roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = math.asin(max(-1.0, min(1.0, 2.0 * (w * y - z * x))))
    yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return roll, pitch, yaw
