"""The timers of an engine's services, in a heap: one deadline for each service."""

from __future__ import annotations

from heapq import heapify, heappop, heappush
from itertools import count
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services import Service

#: Maximum number of outdated entries in the heap; then the heap is rebuilt.
MAX_OUTDATED_TIMERS = 1000


class ServiceTimers:
    """The deadlines of services."""

    def __init__(self) -> None:
        self._timers: list[tuple[float, int, Service]] = []
        self._due: dict[Service, float] = {}
        self._order = count()

    def set(self, service: Service, due: float | None) -> None:
        """Set the deadline of a service; None: it has none."""
        if due is None:
            self._due.pop(service, None)
        elif self._due.get(service) != due:
            self._due[service] = due
            heappush(self._timers, (due, next(self._order), service))
            if len(self._timers) > len(self._due) + MAX_OUTDATED_TIMERS:
                self._timers = [timer for timer in self._timers if self._due.get(timer[2]) == timer[0]]
                heapify(self._timers)

    def next_timeout(self) -> float | None:
        """Return the earliest deadline."""
        while self._timers and self._due.get(self._timers[0][2]) != self._timers[0][0]:
            heappop(self._timers)
        return self._timers[0][0] if self._timers else None

    def pop_due(self, now: float) -> Iterator[Service]:
        """Yield the services whose deadline is reached, and forget the deadline."""
        while self._timers and self._timers[0][0] <= now:
            due, _, service = heappop(self._timers)
            if self._due.get(service) == due:
                del self._due[service]
                yield service
