"""A failsafe: a condition that must last for some time, a reaction, and a second one when it ends.

Condition, time and reactions come from the firmware. While a failsafe is active its name is in
`autopilot.failsafes`, which makes the vehicle's state critical.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot


def nothing() -> None:
    """Do nothing at the end of a failsafe."""


class Failsafe:
    """One failsafe; `delay` returns the seconds that the condition must last, read again each time."""

    def __init__(
        self,
        autopilot: SimulatedAutopilot,
        name: str,
        is_wrong: Callable[[], bool],
        delay: Callable[[], float],
        begin: Callable[[], None],
        end: Callable[[], None] = nothing,
    ) -> None:
        self.name = name
        self._autopilot = autopilot
        self._is_wrong, self._delay = is_wrong, delay
        self._begin, self._end = begin, end
        self._since: float | None = None
        self.active = False

    def tick(self, now: float) -> None:
        """Check the condition, and react to a change."""
        if not self._is_wrong():
            self._since = None
            if self.active:
                self.active = False
                self._autopilot.failsafes.discard(self.name)
                self._end()
            return
        if self._since is None:
            self._since = now
        if not self.active and now - self._since >= self._delay():
            self.active = True
            self._autopilot.failsafes.add(self.name)
            self._begin()
