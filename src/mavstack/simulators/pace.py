"""The pace of a simulation: its speed beside real time, pauses and single steps. Without a clock."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable

#: Maximum lag in seconds that the simulation catches up; a larger lag remains.
MAX_LAG: Final = 0.1
#: Minimum sleep in seconds: shorter ones take longer than requested.
_SHORTEST: Final = 0.001


class Pace:
    """Holds a simulation back.

    Args:
        speed: Simulated seconds in a real second; 0: as fast as possible.
        changed: Called when a step that had to wait may begin.

    Raises:
        InvalidArgumentError: The speed is negative or not finite.
    """

    def __init__(self, speed: float = 1.0, changed: Callable[[], None] = lambda: None) -> None:
        self._changed = changed
        self._steps: int | None = None  # steps until a pause; None: no pause
        self._begun: tuple[float, float] | None = None
        self._speed = _checked(speed)

    @property
    def speed(self) -> float:
        """Simulated seconds in a real second; 0: as fast as possible."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._speed = _checked(speed)
        self._begun = None
        self._changed()

    @property
    def is_paused(self) -> bool:
        """True after `pause` and its steps, until `resume`."""
        return self._steps == 0

    def pause(self, steps: int = 0) -> None:
        """Pause after some more steps.

        Raises:
            InvalidArgumentError: The number is negative.
        """
        if steps < 0:
            raise InvalidArgumentError(f"the number of steps must be 0 or more, got {steps}")
        self._steps = steps
        self._begun = None
        self._changed()

    def resume(self) -> None:
        """Continue after a pause."""
        self._steps = self._begun = None
        self._changed()

    def delay(self, time: float, now: float) -> float | None:
        """Return the real seconds until the next step may begin.

        Args:
            time: Seconds of the simulation.
            now: Seconds of the real clock.

        Returns:
            The seconds; None: the simulation is paused.
        """
        if self._steps == 0:
            return None
        if not self._speed:
            return 0.0
        if self._begun is None:
            self._begun = (now, time)
        ahead = (time - self._begun[1]) / self._speed - (now - self._begun[0])
        if ahead < -MAX_LAG:
            self._begun = (now, time)
        return ahead if ahead > _SHORTEST else 0.0

    def count(self) -> None:
        """Count a step that begins."""
        if self._steps:
            self._steps -= 1


def _checked(speed: float) -> float:
    if not (math.isfinite(speed) and speed >= 0.0):
        raise InvalidArgumentError(f"the speed must be 0 or more, got {speed:g}")
    return speed
