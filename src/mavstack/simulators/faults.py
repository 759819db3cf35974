"""Faults of sensors, by name, from one time of the simulation to another."""

from __future__ import annotations

import math
from typing import Final

from mavstack.errors import InvalidArgumentError

#: The effect of each fault, by name.
FAULTS: Final = {
    "gps-lost": "no position fix",
    "gps-frozen": "the receiver keeps its last position",
    "gps-jumped": "the position is 50 m north of the true one",
    "imu-frozen": "accelerometer and gyroscope keep their last values",
    "imu-biased": "the accelerometer reads 2 m/s2 too much forward, the gyroscope 0.2 rad/s to the right",
    "imu-shaken": "accelerometer and gyroscope have fifty times their noise",
    "magnetometer-disturbed": "the magnetic field is turned and doubled",
    "magnetometer-frozen": "the magnetometer keeps its last values",
    "barometer-blocked": "the barometer keeps its last value",
    "airspeed-blocked": "the airspeed sensor reads zero",
    "rangefinder-lost": "the rangefinder measures nothing",
    "flow-lost": "the optical flow has no quality",
    "battery-low": "the battery has 20 % less voltage",
}


class Faults:
    """The faults of one vehicle.

    Attributes:
        active: The names of the faults that are present now.
    """

    def __init__(self) -> None:
        self.active: set[str] = set()
        self._planned: list[tuple[float, float, str]] = []
        self._time = 0.0

    def inject(self, name: str, *, after: float = 0.0, duration: float | None = None) -> None:
        """Plan a fault.

        Args:
            name: A key of `FAULTS`.
            after: Simulated seconds from now until it begins.
            duration: Simulated seconds that it lasts; None: until `clear`.

        Raises:
            InvalidArgumentError: There is no such fault, or a time is negative or not finite.
        """
        _check(name)
        for label, value in (("after", after), ("duration", duration)):
            if value is not None and not (math.isfinite(value) and value >= 0.0):
                raise InvalidArgumentError(
                    f"injecting {name} failed: {label} must be 0 or more, got {value:g}"
                )
        begin = self._time + after
        self._planned.append((begin, math.inf if duration is None else begin + duration, name))
        self.update(self._time)

    def clear(self, name: str | None = None) -> None:
        """End a fault, planned ones too; None: all of them.

        Raises:
            InvalidArgumentError: There is no such fault.
        """
        if name is not None:
            _check(name)
        self._planned = [each for each in self._planned if name is not None and each[2] != name]
        self.update(self._time)

    def update(self, time: float) -> None:
        """Begin and end the faults that are due."""
        self._time = time
        if self._planned or self.active:
            self.active = {name for begin, end, name in self._planned if begin <= time < end}


def _check(name: str) -> None:
    if name not in FAULTS:
        raise InvalidArgumentError(f"there is no fault {name!r}: {', '.join(FAULTS)}")
