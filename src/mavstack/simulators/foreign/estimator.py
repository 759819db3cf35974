"""An estimate of attitude, velocity and position from sensors alone: a complementary filter.

The gyroscope turns the attitude; the accelerometer levels it while it measures about gravity alone, the
magnetometer turns it to the north. Velocity and position follow the accelerometer, and are drawn to the GPS
reports. It is as simple as a filter that flies may be: it has no biases and no covariances.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from mavstack.rotation import LEVEL, from_euler, rotate, rotate_back, to_euler, turned
from mavstack.simulators.state import GRAVITY

if TYPE_CHECKING:
    from mavstack.rotation import Quaternion, Vector

#: Gains: tilt in 1/s, heading per sample, position and velocity per report.
_TILT, _HEADING, _POSITION, _VELOCITY = 0.4, 0.05, 0.3, 0.4
#: Maximum deviation of the specific force from gravity, as a share, at which it corrects the tilt.
_CALM: Final = 0.15


class Estimator:
    """The estimate of one body.

    Attributes:
        attitude: From body axes to north, east, down.
        position: Metres north, east, down of home.
        velocity: Metres per second north, east, down.
        is_aligned: The first accelerometer sample has levelled it.
    """

    def __init__(self) -> None:
        self.attitude: Quaternion = LEVEL
        self.position: Vector = (0.0, 0.0, 0.0)
        self.velocity: Vector = (0.0, 0.0, 0.0)
        self.is_aligned = False
        self._has_heading = self._has_place = False

    def predict(self, force: Vector, rates: Vector, dt: float) -> None:
        """Take accelerometer (m/s2) and gyroscope (rad/s) of a step of some seconds."""
        if not self.is_aligned:
            x, y, z = force
            self.attitude = from_euler(math.atan2(-y, -z), math.atan2(x, math.hypot(y, z)), 0.0)
            self.is_aligned = True
        self.attitude = turned(self.attitude, self._levelled(force, rates), dt)
        if not self._has_place:
            return
        north, east, down = rotate(self.attitude, force)
        v, p = self.velocity, self.position
        self.velocity = v = (v[0] + north * dt, v[1] + east * dt, v[2] + (down + GRAVITY) * dt)
        self.position = (p[0] + v[0] * dt, p[1] + v[1] * dt, p[2] + v[2] * dt)

    def _levelled(self, force: Vector, rates: Vector) -> Vector:
        """Return the rates with a turn that levels the attitude."""
        size = math.hypot(*force)
        if abs(size - GRAVITY) > _CALM * GRAVITY:
            return rates
        x, y, z = (-value / size for value in force)
        a, b, c = rotate_back(self.attitude, (0.0, 0.0, 1.0))
        gain = _TILT
        return (
            rates[0] + gain * (y * c - z * b),
            rates[1] + gain * (z * a - x * c),
            rates[2] + gain * (x * b - y * a),
        )

    def take_field(self, field: Vector, declination: float) -> None:
        """Take the magnetic field in body axes, with the declination of the place in radians."""
        roll, pitch, yaw = to_euler(self.attitude)
        north, east, _ = rotate(from_euler(roll, pitch, 0.0), field)
        heading = declination - math.atan2(east, north)
        error = math.remainder(heading - yaw, math.tau)
        gain = _HEADING if self._has_heading else 1.0
        self._has_heading = True
        self.attitude = from_euler(roll, pitch, yaw + gain * error)

    def take_place(self, position: Vector, velocity: Vector) -> None:
        """Take a GPS report: metres and m/s north, east, down."""
        gains = (_POSITION, _VELOCITY) if self._has_place else (1.0, 1.0)
        self._has_place = True
        self.position = _drawn(self.position, position, gains[0])
        self.velocity = _drawn(self.velocity, velocity, gains[1])


def _drawn(value: Vector, target: Vector, gain: float) -> Vector:
    return (
        value[0] + gain * (target[0] - value[0]),
        value[1] + gain * (target[1] - value[1]),
        value[2] + gain * (target[2] - value[2]),
    )
