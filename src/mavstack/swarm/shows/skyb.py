"""`.skyb` files, which a vehicle with Skybrush's firmware flies: trajectory and lights of one vehicle.

    "skyb", version 2, features (bit 0: CRC), CRC32, blocks: type, length (16 bits), body

The trajectory is a start and curves of degree 0, 1, 3 or 7 for each axis, as 16 bit numbers in units of
`scale` millimetres. A curve of another degree is raised to the next one; one that lasts longer than 65 s is
cut. The CRC is that of ZIP without its inversions, over the file with zeros in its place.
"""

from __future__ import annotations

import math
import struct
import zlib
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.shows.show import Curve, ShowVehicle, Trajectory

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.swarm.arrays import Points

_MAGIC: Final = b"skyb"
_CRC: Final = 1
_HEAD: Final = 10
_TRAJECTORY: Final = 1
_LIGHTS: Final = 2
#: Degree of a curve by its code.
_DEGREES: Final = (0, 1, 3, 7)
_MAX_MILLISECONDS: Final = 65_000
_MAX_SCALE: Final = 127
_MAX_BLOCK: Final = 0xFFFF


def write_skyb(vehicle: ShowVehicle) -> bytes:
    """Return the file of a vehicle.

    Raises:
        InvalidArgumentError: Its trajectory is too long or too far for the format.
    """
    blocks = [(_TRAJECTORY, _trajectory(vehicle.trajectory))]
    if vehicle.lights:
        blocks.append((_LIGHTS, vehicle.lights))
    data = bytearray(_MAGIC + bytes((2, _CRC, 0, 0, 0, 0)))
    for kind, body in blocks:
        if len(body) > _MAX_BLOCK:
            raise InvalidArgumentError(
                f"a part of {vehicle.name} has {len(body)} bytes, the format holds {_MAX_BLOCK}"
            )
        data += struct.pack("<BH", kind, len(body)) + body
    data[6:_HEAD] = struct.pack("<I", _checksum(bytes(data)))
    return bytes(data)


def read_skyb(data: bytes, name: str = "") -> ShowVehicle:
    """Read the file of a vehicle.

    Args:
        data: Its content.
        name: The name of the vehicle.

    Raises:
        InvalidArgumentError: It is not such a file, or it is damaged.
    """
    try:
        if data[:4] != _MAGIC or data[4] not in (1, 2):
            raise InvalidArgumentError("it is not a .skyb file")
        position = 5
        if data[4] == 2:
            position = _HEAD if data[5] & _CRC else 6
            if data[5] & _CRC and struct.unpack_from("<I", data, 6)[0] != _checksum(data):
                raise InvalidArgumentError("its checksum is wrong")
        found: dict[int, bytes] = {}
        while position < len(data):
            kind, length = struct.unpack_from("<BH", data, position)
            found[kind] = data[position + 3 : position + 3 + length]
            position += 3 + length
        trajectory = Trajectory(list(_curves(found[_TRAJECTORY])))
    except (struct.error, IndexError, KeyError):
        raise InvalidArgumentError("it ends in the middle") from None
    return ShowVehicle(name, trajectory, found.get(_LIGHTS, b""))


def _checksum(data: bytes) -> int:
    blank = data[:6] + bytes(4) + data[_HEAD:]
    return zlib.crc32(blank, 0xFFFFFFFF) ^ 0xFFFFFFFF


def _trajectory(trajectory: Trajectory) -> bytes:
    largest = max(float(np.abs(np.asarray(each.points)).max()) for each in trajectory.curves)
    scale = max(1, math.ceil(largest * 1000.0 / 32767.0))
    if scale > _MAX_SCALE:
        raise InvalidArgumentError(f"a trajectory reaches {largest:.0f} m, the format holds 4161 m")
    start = _units(np.asarray(trajectory.curves[0].points[0]), scale)
    data = bytearray(struct.pack("<Bhhhh", scale, *start, 0))
    if trajectory.begin > 0.0:  # the vehicle waits for its takeoff
        waiting = Curve(0.0, trajectory.begin, (trajectory.curves[0].points[0],) * 2)
        data += b"".join(_segment(each, scale) for each in _pieces(waiting))
    for curve in trajectory.curves:
        data += b"".join(_segment(each, scale) for each in _pieces(curve))
    return bytes(data)


def _pieces(curve: Curve) -> Iterator[Curve]:
    """Yield a curve in parts that the format holds; both ends of each are rounded to milliseconds."""
    count = math.ceil(curve.duration * 1000.0 / _MAX_MILLISECONDS)
    control = np.asarray(curve.points, dtype=float)
    for index in range(count):
        first, control = _split(control, 1.0 / (count - index)) if index < count - 1 else (control, control)
        length = curve.duration / count
        points = [(float(x), float(y), float(z)) for x, y, z in first]
        yield Curve(curve.begin + index * length, length, points)


def _split(control: Points, share: float) -> tuple[Points, Points]:
    """Return both parts of a Bézier curve (de Casteljau)."""
    first, second = [control[0]], [control[-1]]
    row = control
    while len(row) > 1:
        row = row[:-1] * (1.0 - share) + row[1:] * share
        first.append(row[0])
        second.append(row[-1])
    return np.array(first), np.array(second[::-1])


def _segment(curve: Curve, scale: int) -> bytes:
    header, values = 0, bytearray()
    control = np.asarray(curve.points, dtype=float)
    for axis in range(3):
        code, numbers = _axis(control[:, axis], scale)
        header |= code << 2 * axis
        values += struct.pack(f"<{len(numbers)}h", *numbers)
    end = round((curve.begin + curve.duration) * 1000.0)
    return struct.pack("<BH", header, end - round(curve.begin * 1000.0)) + values


def _axis(control: Points, scale: int) -> tuple[int, Sequence[int]]:
    """Return the code of the degree of one coordinate, and its numbers without the start."""
    if np.ptp(control) * 1000.0 < 0.5 * scale:
        return 0, ()
    code = next(code for code, degree in enumerate(_DEGREES) if degree >= len(control) - 1)
    while len(control) - 1 < _DEGREES[code]:
        control = _raised(control)
    return code, _units(control[1:], scale)


def _raised(control: Points) -> Points:
    """Return the control values of the same curve with one more degree."""
    degree = len(control)
    weights = np.arange(1, degree) / degree
    return np.concatenate((control[:1], weights * control[:-1] + (1.0 - weights) * control[1:], control[-1:]))


def _units(values: Points, scale: int) -> list[int]:
    return [int(each) for each in np.rint(values * 1000.0 / scale)]


def _curves(data: bytes) -> Iterator[Curve]:
    scale, *start = struct.unpack_from("<Bhhhh", data)
    here, position, begin = list(start[:3]), 9, 0
    unit = (scale & 0x7F) / 1000.0
    while position < len(data):
        header, duration = struct.unpack_from("<BH", data, position)
        position += 3
        axes: list[list[int]] = []
        for axis in range(3):
            count = _DEGREES[header >> 2 * axis & 3]
            axes.append([here[axis], *struct.unpack_from(f"<{count}h", data, position)])
            position += 2 * count
        degree = max(len(each) for each in [*axes, [0, 0]])
        columns = [_to_degree(np.array(each, dtype=float), degree - 1) * unit for each in axes]
        points = [(float(x), float(y), float(z)) for x, y, z in zip(*columns, strict=True)]
        yield Curve(begin / 1000.0, duration / 1000.0, points)
        here, begin = [each[-1] for each in axes], begin + duration


def _to_degree(control: Points, degree: int) -> Points:
    while len(control) - 1 < degree:
        control = np.repeat(control, 2) if len(control) == 1 else _raised(control)
    return control
