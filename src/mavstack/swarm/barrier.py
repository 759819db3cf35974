"""Barriers: a phase begins when every member has arrived in the one before.

    barrier = Barrier(members, timeout=30.0, now=now)
    exchange.report_arrivals(barrier, phase=1, now=now)      # SWARM_INTENT of the other members
    barrier.arrive(own_system)
    barrier.state(now)                                       # WAITING, OPEN, or BROKEN after the timeout

Each member has a barrier for each phase, and decides by its own one: no program has to know all members. A
member that is lost may still be on its way, so the others wait for it until the timeout; then the barrier is
broken, `missing` names it, and the program decides on the next phase.
"""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


class BarrierState(StrEnum):
    """The state of a barrier."""

    WAITING = "waiting"
    OPEN = "open"
    BROKEN = "broken"


class Barrier:
    """A point at which members wait for each other.

    Args:
        members: The members.
        timeout: Seconds until the barrier is broken; None waits for ever.
        now: Seconds.
    """

    def __init__(self, members: Iterable[int], *, timeout: float | None, now: float) -> None:
        self._missing = set(members)
        self._deadline = None if timeout is None else now + timeout

    @property
    def missing(self) -> tuple[int, ...]:
        """The members that are not ready, in the order of their numbers."""
        return tuple(sorted(self._missing))

    def arrive(self, member: int) -> None:
        """Note that a member is ready; a member that is not part of the barrier is ignored."""
        self._missing.discard(member)

    def state(self, now: float) -> BarrierState:
        """Return whether the next phase may begin."""
        if not self._missing:
            return BarrierState.OPEN
        expired = self._deadline is not None and now >= self._deadline
        return BarrierState.BROKEN if expired else BarrierState.WAITING
