"""Errors of one sensor: noise, bias, drift, delay and rate, from one source of random numbers."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable

#: Tolerance in seconds for comparing the times of samples.
_ROUNDING = 1e-7


@dataclass(frozen=True, slots=True)
class SensorModel:
    """The errors of one sensor, in its unit.

    Attributes:
        noise: Standard deviation of each sample.
        bias: Constant error of each axis; one number for all axes.
        drift: Standard deviation of the change of the bias in a second (a random walk).
        delay: Seconds between a measurement and its report.
        rate: Samples in a second; 0: one with each step.

    Raises:
        InvalidArgumentError: A number is negative or not finite.
    """

    noise: float = 0.0
    bias: float | tuple[float, ...] = 0.0
    drift: float = 0.0
    delay: float = 0.0
    rate: float = 0.0

    def __post_init__(self) -> None:
        for name in ("noise", "drift", "delay", "rate"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise InvalidArgumentError(f"the {name} of a sensor must be 0 or more, got {value:g}")


@dataclass(frozen=True, slots=True)
class SensorModels:
    """The errors of all sensors; the defaults are those of a low-cost autopilot.

    Attributes:
        accelerometer: m/s2.
        gyroscope: rad/s.
        magnetometer: Gauss.
        barometer: Metres of altitude.
        airspeed: Metres per second.
        position: Metres north, east, down of GPS; its noise walks slowly.
        velocity: Metres per second north, east, down of GPS, reported with the position.
        rangefinder: Metres.
        flow: rad/s of the optical flow.
    """

    accelerometer: SensorModel = SensorModel(noise=0.03)
    gyroscope: SensorModel = SensorModel(noise=0.003)
    magnetometer: SensorModel = SensorModel(noise=0.002, rate=50.0)
    barometer: SensorModel = SensorModel(noise=0.1, rate=50.0)
    airspeed: SensorModel = SensorModel(noise=0.2, rate=50.0)
    position: SensorModel = SensorModel(noise=0.3, rate=10.0)
    velocity: SensorModel = SensorModel(noise=0.05, rate=10.0)
    rangefinder: SensorModel = SensorModel(noise=0.02, rate=20.0)
    flow: SensorModel = SensorModel(noise=0.02, rate=20.0)

    @classmethod
    def ideal(cls) -> SensorModels:
        """Return sensors without errors, at their rates."""
        usual = cls()
        return cls(**{each.name: SensorModel(rate=getattr(usual, each.name).rate) for each in fields(cls)})


class SensorChannel:
    """One sensor: true values in, samples out.

    Args:
        model: Its errors.
        gauss: A source of normally distributed numbers, by mean and standard deviation.
        size: The number of axes.

    Attributes:
        due: The time of the next sample, before which `measure` need not be called.
    """

    __slots__ = (
        "_bias",
        "_first",
        "_gauss",
        "_history",
        "_model",
        "_next",
        "_noise",
        "_simple",
        "_time",
        "due",
    )

    def __init__(self, model: SensorModel, gauss: Callable[[float, float], float], size: int) -> None:
        self._model, self._gauss, self._noise = model, gauss, model.noise
        bias = model.bias if isinstance(model.bias, tuple) else (model.bias,) * size
        if len(bias) != size:
            raise InvalidArgumentError(f"the bias of a sensor must have {size} axes, got {len(bias)}")
        self._bias = list(bias)
        self._simple = not (model.rate or model.delay or model.drift or any(bias))
        self._history: deque[tuple[float, tuple[float, ...]]] = deque()
        self._first: float | None = None
        self._next = self.due = -math.inf
        self._time: float | None = None

    def measure(self, time: float, values: tuple[float, ...]) -> tuple[float, ...] | None:
        """Return the next sample.

        Args:
            time: Seconds of the simulation.
            values: The true values now.

        Returns:
            The sample; None between two samples.
        """
        noise, gauss = self._noise, self._gauss
        if self._simple:
            return tuple([value + gauss(0.0, noise) for value in values])
        if self._model.delay:
            values = self._delayed(time, values)
        if self._model.rate and not self._is_due(time):
            return None
        if self._model.drift:
            self._walk(time)
        return tuple(
            [value + bias + gauss(0.0, noise) for value, bias in zip(values, self._bias, strict=True)]
        )

    def _is_due(self, time: float) -> bool:
        if self._first is None:
            self._first = time
        elif time < self._next - _ROUNDING:
            return False
        rate = self._model.rate
        self._next = self._first + (math.floor((time - self._first + 2 * _ROUNDING) * rate) + 1) / rate
        if not self._model.delay:  # a delayed sensor must record the values of each step
            self.due = self._next - _ROUNDING
        return True

    def _delayed(self, time: float, values: tuple[float, ...]) -> tuple[float, ...]:
        history, due = self._history, time - self._model.delay + _ROUNDING
        history.append((time, values))
        while len(history) > 1 and history[1][0] <= due:
            history.popleft()
        return history[0][1]

    def _walk(self, time: float) -> None:
        if self._time is not None:
            change = self._model.drift * math.sqrt(max(time - self._time, 0.0))
            self._bias = [bias + self._gauss(0.0, change) for bias in self._bias]
        self._time = time
