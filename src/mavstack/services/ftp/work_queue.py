"""The queue of requests that name a path, which may take long; checksums are computed in slices.

A server executes few slices at a time with pauses between them, so that other services, and other vehicles
in the process, continue meanwhile. Clients take turns, each with few waiting requests: a client that sends
many requests delays only itself.
"""

from __future__ import annotations

from collections import OrderedDict, deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Generator

    from mavstack.services.addressing import Address
    from mavstack.services.ftp.payload import FtpPayload

#: The largest number of clients with waiting requests, and of waiting requests of each client. Further
#: requests are dropped; the client repeats them.
MAX_WAITING_CLIENTS, MAX_WAITING_REQUESTS = 64, 4
#: The average seconds from one slice to the next, and the number of slices that run at once after a pause.
SLICE_INTERVAL, MAX_SLICES_AT_ONCE = 0.002, 8

#: The execution of a request: yields after each slice, and returns the reply.
Steps: TypeAlias = "Generator[None, None, FtpPayload]"


@dataclass(slots=True, eq=False)
class Work:
    """A waiting request; `steps` is None until it is executed for the first time."""

    request: FtpPayload
    source: Address
    steps: Steps | None = None


class WorkQueue:
    """The waiting requests of all clients of one server."""

    def __init__(self) -> None:
        self._clients: OrderedDict[Address, deque[Work]] = OrderedDict()
        self._due = 0.0  # the time of the next slice; in the past after a pause

    def add(self, source: Address, request: FtpPayload) -> None:
        """Add a request, unless it is waiting already or its client has too many waiting requests."""
        waiting = self._clients.get(source)
        if waiting is None:
            if len(self._clients) >= MAX_WAITING_CLIENTS:
                return
            waiting = self._clients[source] = deque()
        if len(waiting) < MAX_WAITING_REQUESTS and all(work.request != request for work in waiting):
            waiting.append(Work(request, source))

    def next(self, now: float) -> Work | None:
        """Return the work whose next slice is due; None if there is none."""
        if not self._clients or now < self._due:
            return None
        return next(iter(self._clients.values()))[0]

    def stepped(self, work: Work, now: float, *, ended: bool) -> None:
        """Record that a slice of the work was executed, and let the next client take its turn."""
        earliest = now - (MAX_SLICES_AT_ONCE - 1) * SLICE_INTERVAL
        self._due = max(self._due, earliest) + SLICE_INTERVAL
        waiting = self._clients.get(work.source)
        if waiting is None:
            return
        self._clients.move_to_end(work.source)
        if ended:
            waiting.popleft()
            if not waiting:
                del self._clients[work.source]

    def discard(self, source: Address) -> None:
        """Discard the waiting requests of a client."""
        for work in self._clients.pop(source, ()):
            if work.steps is not None:
                work.steps.close()

    def next_timeout(self) -> float | None:
        """Return when the next slice is due."""
        return self._due if self._clients else None
