"""Sensors of a simulated body: true values with their errors and faults, the same for the same seed.

`Sensors.sample` takes the state of a step and returns `Readings`: accelerometer and gyroscope with each step,
the others when they are due. Every sample has noise, because estimators take values that do not change for a
dead sensor. The magnetic field is the World Magnetic Model, the air the standard atmosphere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from random import Random
from typing import TYPE_CHECKING, Final, Protocol, cast

from mavstack.errors import InvalidArgumentError
from mavstack.geodesy import LocalFrame
from mavstack.rotation import rotate_back
from mavstack.simulators.atmosphere import STANDARD, Atmosphere
from mavstack.simulators.faults import Faults
from mavstack.simulators.magnetic_model import magnetic_field
from mavstack.simulators.sensor_model import SensorChannel, SensorModel, SensorModels

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.rotation import Vector
    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.state import State

#: Sensors that a vehicle has only on request.
EQUIPMENT: Final = ("rangefinder", "optical-flow")
#: The range of the rangefinder in metres, and the minimum cosine of its tilt.
MIN_RANGE, MAX_RANGE, _MIN_COSINE = 0.1, 40.0, 0.5
#: The battery of a body that does not model a battery: volts and amperes.
BATTERY: Final = (16.2, 1.0)
_BIASES: Final = ((2.0, 0.0, 0.0), (0.2, 0.0, 0.0))
_JUMP, _SHAKING, _SAG = 50.0, 50.0, 0.8
#: Gyroscope noise of a moving vehicle as a multiple of the noise at rest, because motors and wheels shake it.
#: Without this noise, PX4 detects rest during a smooth run on the ground and holds its velocity estimate at
#: zero.
_VIBRATION: Final = 8.0


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


@dataclass(frozen=True, slots=True)
class Flow:
    """A report of an optical flow sensor that looks down.

    Attributes:
        rates: rad/s of the flow about the body's forward and right axes.
        turn: rad/s of the body about its three axes.
        interval: Seconds since the report before.
        quality: 0 (none) to 255.
        distance: Metres to the ground.
    """

    rates: tuple[float, float]
    turn: Vector
    interval: float
    quality: int
    distance: float


@dataclass(frozen=True, slots=True)
class Readings:
    """The samples of one step; None: no new sample.

    Attributes:
        acceleration: The accelerometer in body axes in m/s2.
        rates: The gyroscope in body axes in rad/s.
        magnetic: Gauss in body axes.
        altitude: Metres above mean sea level by pressure in the standard atmosphere of the day.
        airspeed: True airspeed in m/s, at least 0.
        fix: The GPS report.
        distance: Metres of the rangefinder; infinite: it measures nothing.
        flow: The optical flow.
        battery: Volts and amperes.
    """

    acceleration: Vector
    rates: Vector
    magnetic: Vector | None = None
    altitude: float | None = None
    airspeed: float | None = None
    fix: Fix | None = None
    distance: float | None = None
    flow: Flow | None = None
    battery: tuple[float, float] = BATTERY


class SensorSource(Protocol):
    """Sensors of a body: simulated or recorded ones."""

    #: The faults that are present or planned.
    faults: Faults
    #: The model of the atmosphere.
    atmosphere: Atmosphere

    def reset(self) -> None:
        """Begin again."""

    def sample(self, state: State, time: float) -> Readings:
        """Return the samples that are due at a time in seconds."""

    def true_place(self, state: State) -> tuple[float, float, float]:
        """Return latitude, longitude (degrees) and altitude (metres above mean sea level) without errors."""


class Sensors:
    """All sensors of one body.

    Args:
        home: The origin of its positions.
        seed: Seed of the noise.
        models: Errors of each sensor; None: those of a low-cost autopilot.
        atmosphere: The air.
        equipment: Sensors that it has beside the usual ones, of `EQUIPMENT`.

    Attributes:
        faults: The faults that are present or planned.
        field: The magnetic field in gauss north, east, down.

    Raises:
        InvalidArgumentError: There is no such equipment.
    """

    def __init__(
        self,
        home: Home,
        seed: int = 1,
        *,
        models: SensorModels | None = None,
        atmosphere: Atmosphere = STANDARD,
        equipment: Iterable[str] = (),
    ) -> None:
        self._seed, self._models = seed, models or SensorModels()
        self.atmosphere, self.equipment = atmosphere, frozenset(equipment)
        if unknown := self.equipment.difference(EQUIPMENT):
            raise InvalidArgumentError(f"there is no equipment {min(unknown)!r}: {', '.join(EQUIPMENT)}")
        self._frame = LocalFrame(home.latitude, home.longitude, home.altitude)
        self.field = magnetic_field(home.latitude, home.longitude, home.altitude)
        self.faults = Faults()
        self.reset()

    def reset(self) -> None:
        """Begin again, with the same noise as the first time; faults stay."""
        gauss, models = Random(self._seed).gauss, self._models
        self._gauss = gauss
        self._accelerometer = SensorChannel(models.accelerometer, gauss, 3)
        self._gyroscope = SensorChannel(models.gyroscope, gauss, 3)
        self._magnetometer = SensorChannel(models.magnetometer, gauss, 3)
        self._barometer = SensorChannel(models.barometer, gauss, 1)
        self._airspeed = SensorChannel(models.airspeed, gauss, 1)
        self._position = SensorChannel(_without_noise(models), gauss, 3)
        self._velocity = SensorChannel(replace(models.velocity, rate=0.0), gauss, 3)
        self._rangefinder = SensorChannel(models.rangefinder, gauss, 1)
        self._flow = SensorChannel(models.flow, gauss, 2)
        self._last_flow: float | None = None
        self._frozen: tuple[Vector, Vector] = ((0.0, 0.0, -9.80665), (0.0, 0.0, 0.0))
        self._frozen_field = self.field
        self._blocked = self._frame.altitude
        self._frozen_position: tuple[Vector, Vector] = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        self._walk = [0.0, 0.0, 0.0]

    def sample(self, state: State, time: float) -> Readings:
        """Measure.

        Args:
            state: The state of the body.
            time: Seconds of the simulation, not less than before.

        Returns:
            The samples that are due.
        """
        self.faults.update(time)
        acceleration, rates = self._inertial(state, time)
        optical: tuple[float | None, Flow | None] = (None, None)
        if self.equipment or state.range is not None:
            optical = self._optical(state, time)
        return Readings(
            acceleration,
            rates,
            self._magnetic(state, time) if time >= self._magnetometer.due else None,
            self._altitude(state, time) if time >= self._barometer.due else None,
            self._airspeeds(state, time) if time >= self._airspeed.due else None,
            self._fix(state, time) if time >= self._position.due else None,
            *optical,
            self._battery(state),
        )

    def true_place(self, state: State) -> tuple[float, float, float]:
        """Return latitude, longitude (degrees) and altitude (metres above mean sea level) without errors."""
        return self._frame.to_global(*state.position)

    def _inertial(self, state: State, time: float) -> tuple[Vector, Vector]:
        active = self.faults.active
        if "imu-frozen" in active:
            return self._frozen
        force, turn = state.specific_force, state.rates
        if "imu-biased" in active:
            force, turn = _sum(force, _BIASES[0]), _sum(turn, _BIASES[1])
        if "imu-shaken" in active:
            force = self._shaken(force, _SHAKING * self._models.accelerometer.noise)
            turn = self._shaken(turn, _SHAKING * self._models.gyroscope.noise)
        elif _is_fast(state.velocity):
            turn = self._shaken(turn, _VIBRATION * self._models.gyroscope.noise)
        old = self._frozen
        acceleration = cast("Vector | None", self._accelerometer.measure(time, force)) or old[0]
        rates = cast("Vector | None", self._gyroscope.measure(time, turn)) or old[1]
        self._frozen = (acceleration, rates)
        return self._frozen

    def _shaken(self, values: Vector, noise: float) -> Vector:
        gauss = self._gauss
        return (values[0] + gauss(0.0, noise), values[1] + gauss(0.0, noise), values[2] + gauss(0.0, noise))

    def _magnetic(self, state: State, time: float) -> Vector | None:
        field, active = self.field, self.faults.active
        if "magnetometer-disturbed" in active:
            field = (-field[0], 2.0 * field[0], 2.0 * field[2])
        sample = cast("Vector | None", self._magnetometer.measure(time, rotate_back(state.attitude, field)))
        if sample is None or "magnetometer-frozen" not in active:
            self._frozen_field = sample or self._frozen_field
            return sample
        return self._frozen_field

    def _altitude(self, state: State, time: float) -> float | None:
        if "barometer-blocked" not in self.faults.active:
            self._blocked = self._frame.altitude - state.position[2]
        sample = self._barometer.measure(time, (self._blocked,))
        return None if sample is None else sample[0]

    def _airspeeds(self, state: State, time: float) -> float | None:
        if "airspeed-blocked" in self.faults.active:
            true = 0.0
        else:
            true = math.hypot(*state.velocity) if state.airspeed is None else state.airspeed
        sample = self._airspeed.measure(time, (true,))
        return None if sample is None else max(sample[0], 0.0)

    def _fix(self, state: State, time: float) -> Fix | None:
        active = self.faults.active
        place = cast("Vector | None", self._position.measure(time, state.position))
        if place is None:
            return None
        velocity = cast("Vector | None", self._velocity.measure(time, state.velocity))
        if "gps-frozen" in active:
            place, velocity = self._frozen_position
        else:
            self._frozen_position = (place, velocity := velocity or state.velocity)
        walk, noise = self._walk, 0.2 * self._models.position.noise
        for axis in range(3):  # the position error is a slow random walk
            walk[axis] = 0.98 * walk[axis] + self._gauss(0.0, noise)
        north, east, down = _sum(place, (walk[0], walk[1], walk[2]))
        if "gps-jumped" in active:
            north += _JUMP
        return Fix(*self._frame.to_global(north, east, down), velocity, "gps-lost" not in active)

    def _optical(self, state: State, time: float) -> tuple[float | None, Flow | None]:
        """Return the samples of rangefinder and optical flow."""
        distance = _distance(state)
        sample = self._rangefinder.measure(time, (distance,))
        seen = None if sample is None else sample[0]
        if seen is not None and "rangefinder-lost" in self.faults.active:
            seen = math.inf
        flow = self._optical_flow(state, time, distance) if "optical-flow" in self.equipment else None
        return seen, flow

    def _optical_flow(self, state: State, time: float, distance: float) -> Flow | None:
        forward, right, _ = rotate_back(state.attitude, state.velocity)
        p, q, _ = state.rates
        sample = self._flow.measure(time, (p - right / distance, q + forward / distance))
        if sample is None:
            return None
        interval = time - self._last_flow if self._last_flow is not None else 1.0 / 20.0
        self._last_flow = time
        is_lost = "flow-lost" in self.faults.active or not math.isfinite(distance)
        return Flow((sample[0], sample[1]), state.rates, interval, 0 if is_lost else 255, distance)

    def _battery(self, state: State) -> tuple[float, float]:
        battery = state.battery or BATTERY
        return (battery[0] * _SAG, battery[1]) if "battery-low" in self.faults.active else battery


def _without_noise(models: SensorModels) -> SensorModel:
    """Return the model of a position, whose noise is a walk that `Sensors` makes."""
    return replace(models.position, noise=0.0)


def _distance(state: State) -> float:
    """Return the metres to the ground along the body's vertical axis; infinite: out of range."""
    if state.range is not None:
        return state.range
    cosine = rotate_back(state.attitude, (0.0, 0.0, 1.0))[2]
    if cosine < _MIN_COSINE:
        return math.inf
    distance = max(-state.position[2] / cosine, MIN_RANGE)
    return distance if distance <= MAX_RANGE else math.inf


def _sum(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _is_fast(velocity: Vector) -> bool:
    """Return whether a velocity is more than 1 m/s in some axis."""
    return max(velocity) > 1.0 or min(velocity) < -1.0
