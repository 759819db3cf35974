"""The pace of a simulation: its speed beside real time, pauses and single steps."""

from __future__ import annotations

import asyncio
import math
from typing import Final

from mavstack.errors import InvalidArgumentError

#: Seconds that the simulation may lag behind before it gives up to catch up.
MAX_LAG: Final = 0.1
#: Seconds of the shortest sleep: shorter ones cost more than they wait.
_SHORTEST: Final = 0.001


class Pace:
    """Holds a simulation back.

    Args:
        speed: Simulated seconds in a real second; 0: as fast as possible.

    Raises:
        InvalidArgumentError: The speed is negative or not finite.
    """

    def __init__(self, speed: float = 1.0) -> None:
        if not (math.isfinite(speed) and speed >= 0.0):
            raise InvalidArgumentError(f"the speed must be 0 or more, got {speed:g}")
        self.speed = speed
        self._runs = asyncio.Event()
        self._runs.set()
        self._steps = 0
        self._begun: tuple[float, float] | None = None

    @property
    def is_paused(self) -> bool:
        """True after `pause`, until `resume`."""
        return not self._runs.is_set()

    def pause(self, steps: int = 0) -> None:
        """Pause after some more steps."""
        self._steps = steps
        self._runs.set() if steps else self._runs.clear()
        self._begun = None

    def resume(self) -> None:
        """Go on after a pause."""
        self._steps = 0
        self._begun = None
        self._runs.set()

    async def wait(self, time: float) -> None:
        """Wait until a step may begin.

        Args:
            time: Seconds of the simulation.
        """
        if not self._runs.is_set():
            await self._runs.wait()
        if self._steps:
            self._steps -= 1
            if not self._steps:
                self._runs.clear()
        if self.speed:
            await self._hold(time)

    async def _hold(self, time: float) -> None:
        now = asyncio.get_running_loop().time()
        if self._begun is None:
            self._begun = (now, time)
        ahead = (time - self._begun[1]) / self.speed - (now - self._begun[0])
        if ahead < -MAX_LAG:
            self._begun = (now, time)
        elif ahead > _SHORTEST:
            await asyncio.sleep(ahead)
