"""What the sensors of a body read.

Inertial, magnetic and pressure sensors read the truth in the body's axes, with white noise and the faults
set; they are worked out for all bodies when the first of them is asked in a step, so that nobody asking
costs nothing and the noise, a function of seed and time (see `noise`), is the same whoever asks. The Earth's
field is that of an axial dipole, the air the standard atmosphere. GPS reports come from `estimate.receive`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, bounded
from mavstack.sim.motion.battery import GRAVITY
from mavstack.sim.motion.fleet import Fleet
from mavstack.sim.motion.readings import SensorReadings

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.sim.motion.geodesy import LocalFrame
    from mavstack.sim.motion.noise import Noise

GYRO_DEVIATION, ACCELERATION_DEVIATION, MAGNETIC_DEVIATION = 0.003, 0.05, 0.002
PRESSURE_DEVIATION, DISTANCE_DEVIATION, HEADING_DEVIATION = 0.015, 0.02, 0.01
#: An accelerometer reads no more than this, in m/s2.
FULL_SCALE = 16 * GRAVITY
#: What a rangefinder looking down can measure, in metres.
NEAREST, FARTHEST = 0.15, 40.0
#: Standard atmosphere: sea level hPa, kelvin, lapse in K/m, exponent; and density in kg/m3.
SEA_LEVEL, KELVIN, LAPSE, EXPONENT, DENSITY = 1013.25, 288.15, 0.0065, 5.2559, 1.225
#: Water's pressure, in hPa a metre.
WATER = 98.0
#: Gauss of the dipole's field at the equator.
EQUATOR_FIELD = 0.31
NO_FIX, FIX_3D = 1, 3
UNKNOWN_ERROR = 99.99
#: GPS_FIX_TYPE, satellites, and the errors it expects, horizontal and vertical.
GOOD_FIX = (FIX_3D, 14, 0.8, 1.3)
_GPS, _LOST, _BARO = Fleet.ROWS["gps"][0], Fleet.ROWS["gps_lost"][0], Fleet.ROWS["baro_drift"][0]
_ROWS = 15


def field(latitude: float) -> tuple[float, float]:
    """Give the Earth's field at a latitude in degrees: gauss northwards and downwards."""
    angle = math.radians(latitude)
    return EQUATOR_FIELD * math.cos(angle), 2.0 * EQUATOR_FIELD * math.sin(angle)


class Sensors:
    """The white-noise sensors of all bodies, worked out once a step if asked."""

    def __init__(self, noise: Noise) -> None:
        self._noise = noise
        self._tick = -1
        self._values = np.zeros((_ROWS, 0))

    def forget(self) -> None:
        """Work out anew at the next question: something was set between steps."""
        self._tick = -1

    def column(self, fleet: Fleet, fields: Array, tick: int, column: int) -> list[float]:
        """Give what one body's sensors read in this step."""
        if self._tick != tick:
            self._values = _measure(fleet, fields, self._noise.white(tick))
            self._tick = tick
        values: list[float] = self._values[:, column].tolist()
        return values


def _measure(fleet: Fleet, fields: Array, white: Array) -> Array:
    """Read all sensors of all bodies; `fields` are north, down (gauss) and height of each origin."""
    out = np.empty_like(white)
    np.multiply(white[:3], GYRO_DEVIATION, out=out[:3])
    out[:3] += fleet.rates
    force = fleet.acceleration.copy()
    force[2] -= GRAVITY
    for row, axis in enumerate((fleet.forward, fleet.right, fleet.below)):
        out[3 + row] = force[0] * axis[0] + force[1] * axis[1] + force[2] * axis[2]
    out[3:6] += ACCELERATION_DEVIATION * white[3:6]
    np.minimum(np.maximum(out[3:6], -FULL_SCALE, out=out[3:6]), FULL_SCALE, out=out[3:6])
    turn = fleet.compass_turn
    north, east = fields[0] * np.cos(turn), -fields[0] * np.sin(turn)
    for row, axis in enumerate((fleet.forward, fleet.right, fleet.below)):
        out[6 + row] = north * axis[0] + east * axis[1] + fields[1] * axis[2]
    out[6:9] += MAGNETIC_DEVIATION * white[6:9]
    _air(fleet, fields[2], white, out)
    height = fleet.floor - fleet.position[2]
    slant = height / np.maximum(fleet.below[2], 0.1) + DISTANCE_DEVIATION * white[11]
    seen = (slant >= NEAREST) & (slant <= FARTHEST) & (fleet.below[2] > 0.5)
    out[12] = np.where(seen, slant, np.nan)
    out[13] = fleet.attitude[2] + turn + HEADING_DEVIATION * white[12]
    return out


def _air(fleet: Fleet, origin: Array, white: Array, out: Array) -> None:
    """Read pressures and temperature."""
    height = bounded(origin - np.minimum(fleet.position[2], 0.0) - fleet.baro_drift, -1000.0, 40_000.0)
    kelvin = KELVIN - LAPSE * np.minimum(height, 11_000.0)
    out[9] = SEA_LEVEL * (1.0 - (LAPSE / KELVIN) * height) ** EXPONENT + PRESSURE_DEVIATION * white[9]
    out[9] += WATER * np.maximum(fleet.position[2], 0.0)
    out[10] = (0.005 * DENSITY) * fleet.airspeed * fleet.airspeed + PRESSURE_DEVIATION * white[10]
    out[11] = kelvin - 273.15


def readings(values: Sequence[float], column: Sequence[float], frame: LocalFrame) -> SensorReadings:
    """Put one body's readings together."""
    lost = column[_LOST] > 0.0
    north, east, down, *velocity = column[_GPS : _GPS + 6]
    fix = (NO_FIX, 0, UNKNOWN_ERROR, UNKNOWN_ERROR) if lost else GOOD_FIX
    heading = math.remainder(values[13], math.tau)
    return SensorReadings._make((*values[:13], heading, *frame.to_global(north, east, down), *velocity, *fix))
