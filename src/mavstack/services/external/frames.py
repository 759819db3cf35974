"""Changes of axes: from the frames of ROS and of cameras to those of MAVLink.

A world frame that knows north is NED or ENU and becomes NED. One that starts where the camera started is FRD,
FLU or RDF, and becomes FRD. A body frame is FRD, FLU or RDF and becomes FRD. RDF (right, down, forward) are
the optical axes of a camera in ROS. Quaternions are (w, x, y, z) and rotate vectors of the body into the
world.
"""

from __future__ import annotations

from enum import StrEnum
from math import copysign, hypot, nan, sqrt
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.rotation import multiply

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mavstack.rotation import Quaternion, Vector

_HALF: Final = sqrt(0.5)
#: The number of entries in the upper right triangle of a covariance matrix, and in the whole of it.
TRIANGLE, FULL = 21, 36
_SIZE: Final = 6
#: The triangle of a covariance that is not known.
UNKNOWN: Final = (nan,) * TRIANGLE


class Frame(StrEnum):
    """A frame, by the directions of its axes.

    Attributes:
        NED: North, east, down: MAVLink's world.
        ENU: East, north, up: the world of ROS.
        FRD: Forward, right, down: MAVLink's body, or a world that starts with the heading of the vehicle.
        FLU: Forward, left, up: the body of ROS, or a world that starts with the heading of the vehicle.
        RDF: Right, down, forward: the optical axes of a camera, or a world that starts with them.
    """

    NED = "NED"
    ENU = "ENU"
    FRD = "FRD"
    FLU = "FLU"
    RDF = "RDF"


#: The world frames whose headings count from north.
NORTHERN: Final = frozenset({Frame.NED, Frame.ENU})

#: For each frame: the axis and the sign that belong to each of the three axes of MAVLink.
_AXES: Final[Mapping[Frame, tuple[tuple[int, float], ...]]] = MappingProxyType(
    {
        Frame.NED: ((0, 1.0), (1, 1.0), (2, 1.0)),
        Frame.ENU: ((1, 1.0), (0, 1.0), (2, -1.0)),
        Frame.FRD: ((0, 1.0), (1, 1.0), (2, 1.0)),
        Frame.FLU: ((0, 1.0), (1, -1.0), (2, -1.0)),
        Frame.RDF: ((2, 1.0), (0, 1.0), (1, 1.0)),
    }
)
#: The same conversions as quaternions.
_ROTATIONS: Final[Mapping[Frame, Quaternion]] = MappingProxyType(
    {
        Frame.NED: (1.0, 0.0, 0.0, 0.0),
        Frame.ENU: (0.0, _HALF, _HALF, 0.0),
        Frame.FRD: (1.0, 0.0, 0.0, 0.0),
        Frame.FLU: (0.0, 1.0, 0.0, 0.0),
        Frame.RDF: (0.5, 0.5, 0.5, 0.5),
    }
)


def _turn(frame: Frame, body: Frame) -> tuple[Quaternion, ...]:
    """Return the matrix that turns a quaternion of two frames into the one of MAVLink's, row by row."""
    w, x, y, z = _ROTATIONS[body]
    units = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    columns = [multiply(multiply(_ROTATIONS[frame], unit), (w, -x, -y, -z)) for unit in units]
    return tuple(zip(*columns, strict=True))


#: The matrices of all pairs of a world and a body, since an orientation is turned for each of 50 messages a
#: second.
_TURNS: Final = MappingProxyType({(frame, body): _turn(frame, body) for frame in Frame for body in Frame})


def to_mavlink(frame: Frame, vector: Sequence[float]) -> Vector:
    """Return a vector of a frame in MAVLink's axes: NED, or FRD."""
    (a, p), (b, q), (c, r) = _AXES[frame]
    return p * vector[a], q * vector[b], r * vector[c]


def orientation_to_mavlink(frame: Frame, body: Frame, orientation: Quaternion) -> Quaternion:
    """Return the orientation of a body in a world frame as that of a FRD body in NED or FRD."""
    w, x, y, z = orientation
    (ww, wx, wy, wz), (xw, xx, xy, xz), (yw, yx, yy, yz), (zw, zx, zy, zz) = _TURNS[frame, body]
    return canonical(
        (
            ww * w + wx * x + wy * y + wz * z,
            xw * w + xx * x + xy * y + xz * z,
            yw * w + yx * x + yy * y + yz * z,
            zw * w + zx * x + zy * y + zz * z,
        )
    )


def covariance_to_mavlink(frame: Frame, covariance: Sequence[float]) -> tuple[float, ...]:
    """Return a covariance in MAVLink's axes, as the upper right triangle of its matrix.

    Args:
        frame: The frame of its axes: x, y, z, and the rotations around them.
        covariance: 36 numbers row by row, or 21 numbers of the upper right triangle.

    Returns:
        21 numbers; the first is NaN if all are 0, which ROS sends for a covariance that is not known.
    """
    if not any(covariance):
        return UNKNOWN
    matrix = [list(covariance[row * _SIZE : (row + 1) * _SIZE]) for row in range(_SIZE)]
    if len(covariance) == TRIANGLE:
        matrix = _symmetric(covariance)
    axes = _AXES[frame]
    places = [(axis, sign) for axis, sign in axes] + [(3 + axis, sign) for axis, sign in axes]
    return tuple(
        p * q * matrix[places[row][0]][places[column][0]]
        for row in range(_SIZE)
        for column in range(row, _SIZE)
        for p, q in ((places[row][1], places[column][1]),)
    )


def _symmetric(triangle: Sequence[float]) -> list[list[float]]:
    """Return the matrix of an upper right triangle."""
    matrix = [[0.0] * _SIZE for _ in range(_SIZE)]
    numbers = iter(triangle)
    for row in range(_SIZE):
        for column in range(row, _SIZE):
            matrix[row][column] = matrix[column][row] = next(numbers)
    return matrix


def canonical(quaternion: Quaternion) -> Quaternion:
    """Return the unit quaternion of a rotation whose first number is not negative."""
    w, x, y, z = quaternion
    length = copysign(hypot(w, x, y, z), w)
    return w / length, x / length, y / length, z / length
