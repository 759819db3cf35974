"""Frames: MAVLink has north-east-down and forward-right-down, ROS the axes of REP 103.

Those are east-north-up for the world and forward-left-up for bodies.

Both changes of axes are their own inverses. MAVLink's quaternions are (w, x, y, z), ROS has (x, y, z, w).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.rotation import Quaternion, Vector

from math import cos, pi, remainder, sin, sqrt
from typing import Final

from mavstack.rotation import rotate as rotate_vector

_HALF: Final = sqrt(0.5)
#: Half the angle from east to north, in radians.
_NORTH: Final = pi / 4


def ned_enu(x: float, y: float, z: float) -> Vector:
    """Return a vector in east-north-up for one in north-east-down, or the reverse."""
    return y, x, -z


def frd_flu(x: float, y: float, z: float) -> Vector:
    """Return a vector in forward-left-up for one in forward-right-down, or the reverse."""
    return x, -y, -z


def to_ros_attitude(w: float, x: float, y: float, z: float) -> Quaternion:
    """Return the attitude of a FLU body in ENU as (x, y, z, w), for a FRD body in NED as (w, x, y, z)."""
    return _HALF * (x + y), _HALF * (x - y), _HALF * (w - z), _HALF * (w + z)


def ros_attitude_of(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the attitude of a FLU body in ENU as (x, y, z, w), for three angles of a FRD body in NED."""
    # Each attitude comes here: the product of `from_euler` in the order of ROS, without a second call.
    roll, pitch, yaw = 0.5 * roll, -0.5 * pitch, _NORTH - 0.5 * yaw
    cr, sr, cp, sp, cy, sy = cos(roll), sin(roll), cos(pitch), sin(pitch), cos(yaw), sin(yaw)
    a, b, c, d = cp * cy, sp * sy, sp * cy, cp * sy
    return sr * a - cr * b, cr * c + sr * d, cr * d - sr * c, cr * a + sr * b


def from_ros_attitude(x: float, y: float, z: float, w: float) -> Quaternion:
    """Return the attitude of a FRD body in NED as (w, x, y, z), for a FLU body in ENU as (x, y, z, w)."""
    return _HALF * (w + z), _HALF * (x + y), _HALF * (x - y), _HALF * (w - z)


def flip_body(w: float, x: float, y: float, z: float) -> Quaternion:
    """Return a rotation between FRD frames as one between FLU frames, both (w, x, y, z), or the reverse."""
    return w, x, -y, -z


def ned_to_enu_yaw(yaw: float) -> float:
    """Return an angle from east, counter-clockwise, for one from north, clockwise, or the reverse."""
    return remainder(pi / 2 - yaw, 2 * pi)


def rotate(q: Quaternion, v: Vector) -> Vector:
    """Return a vector rotated by a quaternion (x, y, z, w)."""
    x, y, z, w = q
    return rotate_vector((w, x, y, z), v)


def conjugate(q: Quaternion) -> Quaternion:
    """Return the reverse rotation of a quaternion (x, y, z, w)."""
    x, y, z, w = q
    return -x, -y, -z, w
