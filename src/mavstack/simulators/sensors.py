"""Sensors of a simulated body: true values with noise, bias, drift and faults, the same for the same seed.

Standard deviations are those of a low-cost autopilot. Every sample has noise, because estimators take values
that do not change for a dead sensor. Faults are set by name while the simulation runs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.geodesy import LocalFrame
from mavstack.sim.motion.sensors import (
    DENSITY,
    EXPONENT,
    KELVIN,
    LAPSE,
    SEA_LEVEL,
    magnetic_field,
)
from mavstack.simulators.rotation import rotate_back

if TYPE_CHECKING:
    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.rotation import Vector
    from mavstack.simulators.state import State

#: The faults, and what each does.
FAULTS: Final = {
    "gps-lost": "no position fix",
    "imu-frozen": "accelerometer and gyroscope keep their last values",
    "imu-biased": "the accelerometer reads 2 m/s2 too much forward, the gyroscope 0.2 rad/s to the right",
    "magnetometer-disturbed": "the magnetic field is turned and doubled",
    "barometer-blocked": "the barometer keeps its last value",
    "airspeed-blocked": "the airspeed sensor reads zero",
}
_BIASES: Final = ((2.0, 0.0, 0.0), (0.2, 0.0, 0.0))


@dataclass(frozen=True, slots=True)
class SensorNoise:
    """Standard deviations of the noise.

    Attributes:
        accelerometer: m/s2.
        gyroscope: rad/s.
        magnetometer: Gauss.
        barometer: Metres of altitude.
        airspeed: Metres per second.
        position: Metres, of the slow walk of a GPS position.
        velocity: Metres per second, of GPS.
    """

    accelerometer: float = 0.03
    gyroscope: float = 0.003
    magnetometer: float = 0.002
    barometer: float = 0.1
    airspeed: float = 0.2
    position: float = 0.3
    velocity: float = 0.05


@dataclass(frozen=True, slots=True)
class Inertial:
    """Accelerometer (m/s2) and gyroscope (rad/s) in body axes."""

    acceleration: Vector
    rates: Vector


@dataclass(frozen=True, slots=True)
class Fix:
    """A GPS report.

    Attributes:
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above mean sea level.
        velocity: Metres per second north, east, down.
        is_valid: False: the receiver has no fix.
    """

    latitude: float
    longitude: float
    altitude: float
    velocity: Vector
    is_valid: bool


class Sensors:
    """All sensors of one body.

    Args:
        home: The origin of its positions.
        seed: Seed of the noise.
        noise: Standard deviations.

    Attributes:
        faults: Names of the faults that are present, of `FAULTS`.
    """

    def __init__(self, home: Home, seed: int = 1, noise: SensorNoise | None = None) -> None:
        self._noise = noise or SensorNoise()
        self._gauss = Random(seed).gauss
        self._frame = LocalFrame(home.latitude, home.longitude, home.altitude)
        north, down = magnetic_field(home.latitude)
        self._field = (north, 0.0, down)
        self.faults: set[str] = set()
        self._frozen = Inertial((0.0, 0.0, -9.81), (0.0, 0.0, 0.0))
        self._blocked = self._frame.altitude
        self._walk = [0.0, 0.0, 0.0]

    def set_fault(self, name: str, *, is_present: bool = True) -> None:
        """Set or clear a fault.

        Raises:
            InvalidArgumentError: There is no such fault.
        """
        if name not in FAULTS:
            raise InvalidArgumentError(f"there is no fault {name!r}: {', '.join(FAULTS)}")
        (self.faults.add if is_present else self.faults.discard)(name)

    def inertial(self, state: State) -> Inertial:
        """Return accelerometer and gyroscope."""
        if "imu-frozen" in self.faults:
            return self._frozen
        noise, gauss = self._noise, self._gauss
        (ax, ay, az), (p, q, r) = state.specific_force, state.rates
        if "imu-biased" in self.faults:
            (bx, by, bz), (bp, bq, br) = _BIASES
            ax, ay, az, p, q, r = ax + bx, ay + by, az + bz, p + bp, q + bq, r + br
        shake, drift = noise.accelerometer, noise.gyroscope
        self._frozen = Inertial(
            (ax + gauss(0.0, shake), ay + gauss(0.0, shake), az + gauss(0.0, shake)),
            (p + gauss(0.0, drift), q + gauss(0.0, drift), r + gauss(0.0, drift)),
        )
        return self._frozen

    def magnetic(self, state: State) -> Vector:
        """Return the magnetic field in body axes in gauss."""
        field = self._field
        if "magnetometer-disturbed" in self.faults:
            field = (-field[0], 2.0 * field[0], 2.0 * field[2])
        x, y, z = rotate_back(state.attitude, field)
        gauss, deviation = self._gauss, self._noise.magnetometer
        return x + gauss(0.0, deviation), y + gauss(0.0, deviation), z + gauss(0.0, deviation)

    def altitude(self, state: State) -> float:
        """Return the altitude by pressure in metres above mean sea level."""
        if "barometer-blocked" not in self.faults:
            self._blocked = self._frame.altitude - state.position[2]
        return self._blocked + self._gauss(0.0, self._noise.barometer)

    def airspeed(self, state: State) -> float:
        """Return the airspeed in m/s, at least 0."""
        if "airspeed-blocked" in self.faults:
            return abs(self._gauss(0.0, self._noise.airspeed))
        true = math.hypot(*state.velocity) if state.airspeed is None else state.airspeed
        return max(true + self._gauss(0.0, self._noise.airspeed), 0.0)

    def fix(self, state: State) -> Fix:
        """Return the next GPS report."""
        noise, gauss, walk = self._noise, self._gauss, self._walk
        for axis in range(3):  # a slow walk, which is what the error of a position is
            walk[axis] = 0.98 * walk[axis] + gauss(0.0, 0.2 * noise.position)
        north, east, down = state.position
        place = self._frame.to_global(north + walk[0], east + walk[1], down + walk[2])
        x, y, z = state.velocity
        deviation = noise.velocity
        velocity = (x + gauss(0.0, deviation), y + gauss(0.0, deviation), z + gauss(0.0, deviation))
        return Fix(*place, velocity, "gps-lost" not in self.faults)

    def true_place(self, state: State) -> tuple[float, float, float]:
        """Return latitude, longitude (degrees) and altitude (metres above mean sea level) without errors."""
        return self._frame.to_global(*state.position)


def pressure_at(altitude: float) -> float:
    """Return the pressure of the standard atmosphere in hPa at an altitude in metres above mean sea level."""
    return SEA_LEVEL * math.pow(1.0 - LAPSE * altitude / KELVIN, EXPONENT)


def temperature_at(altitude: float) -> float:
    """Return the temperature of the standard atmosphere in degrees Celsius."""
    return KELVIN - 273.15 - LAPSE * altitude


def dynamic_pressure(airspeed: float) -> float:
    """Return the dynamic pressure in hPa of an airspeed in m/s at sea level."""
    return 0.5 * DENSITY * airspeed * airspeed / 100.0
