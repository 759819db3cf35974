"""Two-way channels without a clock or sockets: impaired networks, and a half-duplex radio.

A channel is given packets with a direction and hands them over when they have arrived. `Network` is two
independent `Flow`s of the link layer's own impairment model. `Radio` is what that model has no word for: one
transmitter shared by both directions, as a pair of serial telemetry radios on one frequency shares it. Each
end has a queue; a packet that finds no room is dropped whole. When the air is free the end that has not just
sent goes first, and a packet holds the air for as long as its bytes take.
"""

from __future__ import annotations

import math
from collections import deque
from enum import IntEnum
from typing import TYPE_CHECKING, Protocol

from mavstack.links.impairment import Flow, Impairment

if TYPE_CHECKING:
    from collections.abc import Callable


class Direction(IntEnum):
    """Which way a packet goes."""

    TO_GROUND = 0
    TO_VEHICLE = 1

    @property
    def other(self) -> Direction:
        """The way back."""
        return Direction(1 - self)


class Channel(Protocol):
    """What the relay drives."""

    splits: bool  # whether it wants single packets, not datagrams

    def send(self, way: Direction, data: bytes, now: float) -> bool:
        """Put something on its way; False if there was no room."""

    def receive(self, now: float) -> list[tuple[Direction, bytes]]:
        """What has arrived by now."""

    def next_timeout(self) -> float | None:
        """When something arrives next."""

    def free(self, way: Direction) -> int | None:
        """The percentage of the queue that is free; None if this is no radio."""

    def lost(self, way: Direction) -> int:
        """How many packets were lost on the air."""


class Network:
    """A network with one impairment for both directions, which do not disturb each other."""

    splits = False

    def __init__(self, impairment: Impairment) -> None:
        self._flows = {way: Flow(impairment, way.name) for way in Direction}

    def send(self, way: Direction, data: bytes, now: float) -> bool:
        """Put a datagram on its way."""
        return self._flows[way].send(data, now)

    def receive(self, now: float) -> list[tuple[Direction, bytes]]:
        """What has arrived by now, of both directions."""
        return [(way, data) for way, flow in self._flows.items() for data in flow.receive(now)]

    def next_timeout(self) -> float | None:
        """When something arrives next."""
        due = [flow.next_timeout() for flow in self._flows.values()]
        return min((when for when in due if when is not None), default=None)

    def free(self, way: Direction) -> int | None:
        """A network does not tell."""
        return None

    def lost(self, way: Direction) -> int:
        """How many datagrams were lost on the way."""
        return self._flows[way].stats.lost


class Radio:
    """A half-duplex radio pair: `bandwidth` bytes a second for both directions together."""

    splits = True

    def __init__(self, bandwidth: float, queue: int) -> None:
        self._bandwidth = bandwidth
        self._limit = queue
        self._waiting: dict[Direction, deque[tuple[float, bytes]]] = {way: deque() for way in Direction}
        self._on_air: deque[tuple[float, Direction, bytes]] = deque()
        self._free_at = -math.inf
        self._last = Direction.TO_GROUND

    def send(self, way: Direction, data: bytes, now: float) -> bool:
        """Queue a packet; False if it was dropped for want of room."""
        self._advance(now)
        if self._queued(way) + len(data) > self._limit:
            return False
        self._waiting[way].append((now, data))
        self._advance(now)
        return True

    def receive(self, now: float) -> list[tuple[Direction, bytes]]:
        """The packets whose last byte has arrived."""
        self._advance(now)
        arrived = []
        while self._on_air and self._on_air[0][0] <= now:
            _, way, data = self._on_air.popleft()
            arrived.append((way, data))
        return arrived

    def next_timeout(self) -> float | None:
        """When the packet on the air has arrived."""
        return self._on_air[0][0] if self._on_air else None

    def free(self, way: Direction) -> int | None:
        """The percentage of that direction's queue that is free."""
        return 100 - 100 * self._queued(way) // self._limit

    def lost(self, way: Direction) -> int:
        """Nothing is lost on the air."""
        return 0

    def _queued(self, way: Direction) -> int:
        return sum(len(data) for _, data in self._waiting[way])

    def _advance(self, now: float) -> None:
        """Start every packet whose turn came until now."""
        while (way := self._next_turn()) is not None:
            queued_at, data = self._waiting[way][0]
            begin = max(queued_at, self._free_at)
            if begin > now:
                return
            self._waiting[way].popleft()
            self._free_at = begin + len(data) / self._bandwidth
            self._on_air.append((self._free_at, way, data))
            self._last = way

    def _next_turn(self) -> Direction | None:
        """The end that did not send last, unless only the other had something when the air became free."""
        ready = [way for way in (self._last.other, self._last) if self._waiting[way]]
        return min(ready, key=lambda way: max(self._waiting[way][0][0], self._free_at), default=None)


CONDITIONS: dict[str, tuple[str, Callable[[int], Channel]]] = {
    "a": ("clean loopback", lambda seed: Network(Impairment(seed=seed))),
    "b": ("20 ms, 1 % loss", lambda seed: Network(Impairment(latency=0.020, loss=0.01, seed=seed))),
    "c": ("half-duplex radio, 57,600 baud", lambda seed: Radio(bandwidth=5760, queue=2048)),
    "d": ("20 ms, 10 % loss", lambda seed: Network(Impairment(latency=0.020, loss=0.10, seed=seed))),
}
