"""A failsafe: a condition that must last for a while, then an action; and a word when all is well again.

What is wrong, for how long, and what is done comes from a firmware. While it is active its name is in
`autopilot.failsafes`, which makes the vehicle's state critical.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.autopilot.interfaces import Autopilot


def nothing() -> None:
    """Do nothing when it is over."""


class Failsafe:
    """One watch; `patience` gives the seconds that the condition must last, read anew each time."""

    def __init__(
        self,
        autopilot: Autopilot,
        name: str,
        is_wrong: Callable[[], bool],
        patience: Callable[[], float],
        begin: Callable[[], None],
        end: Callable[[], None] = nothing,
    ) -> None:
        self.name = name
        self._autopilot = autopilot
        self._is_wrong, self._patience = is_wrong, patience
        self._begin, self._end = begin, end
        self._since: float | None = None
        self.active = False

    def tick(self, now: float) -> None:
        """Look, and act on a change."""
        if not self._is_wrong():
            self._since = None
            if self.active:
                self.active = False
                self._autopilot.failsafes.discard(self.name)
                self._end()
            return
        if self._since is None:
            self._since = now
        if not self.active and now - self._since >= self._patience():
            self.active = True
            self._autopilot.failsafes.add(self.name)
            self._begin()
