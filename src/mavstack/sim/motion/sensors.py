"""Sensor readings of a body.

Inertial, magnetic and pressure sensors read the true motion in body axes, with white noise and the faults
that are set. They are computed for all bodies when the first reading of a step is requested, so that unread
sensors cost nothing, and the noise, a function of seed and time (see `noise`), does not depend on the reader.
The Earth's magnetic field is that of an axial dipole, the air the standard atmosphere. GPS reports come from
`estimate.update_gps`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, clip
from mavstack.sim.motion.battery import GRAVITY
from mavstack.sim.motion.readings import FIX_3D, NO_FIX, UNKNOWN_ERROR, SensorReadings
from mavstack.sim.motion.state import StateArray

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.geodesy import LocalFrame
    from mavstack.sim.motion.noise import Noise

GYRO_DEVIATION, ACCELERATION_DEVIATION, MAGNETIC_DEVIATION = 0.003, 0.05, 0.002
PRESSURE_DEVIATION, DISTANCE_DEVIATION, HEADING_DEVIATION = 0.015, 0.02, 0.01
#: Maximum reading of an accelerometer, in m/s2.
FULL_SCALE = 16 * GRAVITY
#: Minimum and maximum range of the downward rangefinder, in metres.
MIN_RANGE, MAX_RANGE = 0.15, 40.0
#: Standard atmosphere: pressure (hPa) and temperature (K) at sea level, lapse rate (K/m), exponent of the
#: pressure formula; density in kg/m3.
SEA_LEVEL, KELVIN, LAPSE, EXPONENT, DENSITY = 1013.25, 288.15, 0.0065, 5.2559, 1.225
#: Water pressure in hPa per metre of depth.
WATER = 98.0
#: Magnetic field at the equator of the Earth's dipole, in gauss.
EQUATOR_FIELD = 0.31
#: A normal fix: GPS_FIX_TYPE, number of satellites, expected horizontal and vertical error in metres.
GOOD_FIX = (FIX_3D, 14, 0.8, 1.3)
#: Fixes with corrections, with the same fields as `GOOD_FIX`, by GPS_FIX_TYPE: RTK float and RTK fixed.
CORRECTED_FIXES = {5: (5, 18, 0.15, 0.25), 6: (6, 20, 0.014, 0.02)}
#: The share of the receiver's error that corrections remove, by GPS_FIX_TYPE.
PRECISION = {5: 0.8, 6: 0.98}
_GPS, _LOST, _BARO, _FIX = (
    StateArray.ROWS["gps"][0],
    StateArray.ROWS["gps_lost"][0],
    StateArray.ROWS["baro_drift"][0],
    StateArray.ROWS["gps_fix"][0],
)
_ROW_COUNT = 15


def magnetic_field(latitude: float) -> tuple[float, float]:
    """Return the Earth's magnetic field at a latitude in degrees: gauss northwards and downwards."""
    angle = math.radians(latitude)
    return EQUATOR_FIELD * math.cos(angle), 2.0 * EQUATOR_FIELD * math.sin(angle)


class Sensors:
    """The white-noise sensors of all bodies, computed once per step on demand."""

    def __init__(self, noise: Noise) -> None:
        self._noise = noise
        self._tick = -1
        self._values = np.zeros((_ROW_COUNT, 0))

    def invalidate(self) -> None:
        """Discard the readings of this step after a row was set between steps."""
        self._tick = -1

    def column(self, state: StateArray, origins: Array, tick: int, column: int) -> list[float]:
        """Return the sensor values of one body in this step."""
        if self._tick != tick:
            self._values = _measure(state, origins, self._noise.white(tick))
            self._tick = tick
        values: list[float] = self._values[:, column].tolist()
        return values


def _measure(state: StateArray, origins: Array, white: Array) -> Array:
    """Return all sensor values of all bodies.

    `origins` has north and down (gauss) and altitude (m) of each origin.
    """
    out = np.empty_like(white)
    np.multiply(white[:3], GYRO_DEVIATION, out=out[:3])
    out[:3] += state.rates
    force = state.acceleration.copy()
    force[2] -= GRAVITY
    for row, axis in enumerate((state.forward, state.right, state.below)):
        out[3 + row] = force[0] * axis[0] + force[1] * axis[1] + force[2] * axis[2]
    out[3:6] += ACCELERATION_DEVIATION * white[3:6]
    np.minimum(np.maximum(out[3:6], -FULL_SCALE, out=out[3:6]), FULL_SCALE, out=out[3:6])
    turn = state.compass_offset
    north, east = origins[0] * np.cos(turn), -origins[0] * np.sin(turn)
    for row, axis in enumerate((state.forward, state.right, state.below)):
        out[6 + row] = north * axis[0] + east * axis[1] + origins[1] * axis[2]
    out[6:9] += MAGNETIC_DEVIATION * white[6:9]
    _air(state, origins[2], white, out)
    height = state.floor - state.position[2]
    slant = height / np.maximum(state.below[2], 0.1) + DISTANCE_DEVIATION * white[11]
    seen = (slant >= MIN_RANGE) & (slant <= MAX_RANGE) & (state.below[2] > 0.5)
    out[12] = np.where(seen, slant, np.nan)
    out[13] = state.attitude[2] + turn + HEADING_DEVIATION * white[12]
    return out


def _air(state: StateArray, origin: Array, white: Array, out: Array) -> None:
    """Write pressures and temperature."""
    height = clip(origin - np.minimum(state.position[2], 0.0) - state.baro_drift, -1000.0, 40_000.0)
    kelvin = KELVIN - LAPSE * np.minimum(height, 11_000.0)
    out[9] = SEA_LEVEL * (1.0 - (LAPSE / KELVIN) * height) ** EXPONENT + PRESSURE_DEVIATION * white[9]
    out[9] += WATER * np.maximum(state.position[2], 0.0)
    out[10] = (0.005 * DENSITY) * state.airspeed * state.airspeed + PRESSURE_DEVIATION * white[10]
    out[11] = kelvin - 273.15


def readings(values: Sequence[float], column: Sequence[float], frame: LocalFrame) -> SensorReadings:
    """Build one body's readings."""
    lost = column[_LOST] > 0.0
    north, east, down, *velocity = column[_GPS : _GPS + 6]
    good = CORRECTED_FIXES.get(int(column[_FIX]), GOOD_FIX)
    fix = (NO_FIX, 0, UNKNOWN_ERROR, UNKNOWN_ERROR) if lost else good
    heading = math.remainder(values[13], math.tau)
    return SensorReadings._make((*values[:13], heading, *frame.to_global(north, east, down), *velocity, *fix))
