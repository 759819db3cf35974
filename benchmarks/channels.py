"""Bidirectional channels without clock or sockets: impaired networks, and a half-duplex radio.

A channel takes packets with a direction and returns them when they have arrived. `Network` has two
independent `Flow`s of the impairment model of `mavstack.links`. `Radio` has one transmitter shared by both
directions, like a pair of telemetry radios on one frequency, which that model does not support. Each end has
a queue; a packet that exceeds the queue is dropped. When the frequency is free, the end that did not send
last sends first, and a packet occupies the frequency for the transmission time of its bytes.
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
    """The direction of a packet."""

    TO_GROUND = 0
    TO_VEHICLE = 1

    @property
    def other(self) -> Direction:
        """The opposite direction."""
        return Direction(1 - self)


class Channel(Protocol):
    """The interface of a channel, as the relay uses it."""

    splits_datagrams: bool  # true if datagrams are split into packets

    def send(self, direction: Direction, data: bytes, now: float) -> bool:
        """Send a packet or datagram; return False if the queue is full."""

    def receive(self, now: float) -> list[tuple[Direction, bytes]]:
        """Return the packets that have arrived."""

    def next_timeout(self) -> float | None:
        """Return the time of the next arrival, or None."""

    def free_percent(self, direction: Direction) -> int | None:
        """Return the free percentage of the queue, or None for a network."""

    def lost(self, direction: Direction) -> int:
        """Return the number of packets lost in transit."""


class Network:
    """A network with the same impairment in both directions, which are independent."""

    splits_datagrams = False

    def __init__(self, impairment: Impairment) -> None:
        self._flows = {direction: Flow(impairment, direction.name) for direction in Direction}

    def send(self, direction: Direction, data: bytes, now: float) -> bool:
        """Send a datagram."""
        return self._flows[direction].send(data, now)

    def receive(self, now: float) -> list[tuple[Direction, bytes]]:
        """Return the datagrams that have arrived, of both directions."""
        return [(direction, data) for direction, flow in self._flows.items() for data in flow.receive(now)]

    def next_timeout(self) -> float | None:
        """Return the time of the next arrival, or None."""
        due = [flow.next_timeout() for flow in self._flows.values()]
        return min((when for when in due if when is not None), default=None)

    def free_percent(self, direction: Direction) -> int | None:
        """Return None, because a network does not report its queue."""
        return None

    def lost(self, direction: Direction) -> int:
        """Return the number of datagrams lost in transit."""
        return self._flows[direction].stats.lost


class Radio:
    """A pair of half-duplex radios: `bandwidth` bytes per second for both directions together."""

    splits_datagrams = True

    def __init__(self, bandwidth: float, queue: int) -> None:
        self._bandwidth = bandwidth
        self._limit = queue
        self._waiting: dict[Direction, deque[tuple[float, bytes]]] = {
            direction: deque() for direction in Direction
        }
        self._in_transit: deque[tuple[float, Direction, bytes]] = deque()
        self._idle_from = -math.inf
        self._last_sender = Direction.TO_GROUND

    def send(self, direction: Direction, data: bytes, now: float) -> bool:
        """Queue a packet; return False if the queue is full."""
        self._advance(now)
        if self._queued(direction) + len(data) > self._limit:
            return False
        self._waiting[direction].append((now, data))
        self._advance(now)
        return True

    def receive(self, now: float) -> list[tuple[Direction, bytes]]:
        """Return the packets whose last byte has arrived."""
        self._advance(now)
        arrived = []
        while self._in_transit and self._in_transit[0][0] <= now:
            _, direction, data = self._in_transit.popleft()
            arrived.append((direction, data))
        return arrived

    def next_timeout(self) -> float | None:
        """Return when the packet in transit arrives, or None."""
        return self._in_transit[0][0] if self._in_transit else None

    def free_percent(self, direction: Direction) -> int | None:
        """Return the free percentage of the queue of a direction."""
        return 100 - 100 * self._queued(direction) // self._limit

    def lost(self, direction: Direction) -> int:
        """Return 0, because the radio loses no packets in transit."""
        return 0

    def _queued(self, direction: Direction) -> int:
        return sum(len(data) for _, data in self._waiting[direction])

    def _advance(self, now: float) -> None:
        """Start the transmission of every packet whose turn has come."""
        while (direction := self._next_turn()) is not None:
            queued_at, data = self._waiting[direction][0]
            begin = max(queued_at, self._idle_from)
            if begin > now:
                return
            self._waiting[direction].popleft()
            self._idle_from = begin + len(data) / self._bandwidth
            self._in_transit.append((self._idle_from, direction, data))
            self._last_sender = direction

    def _next_turn(self) -> Direction | None:
        """Return the end that sends next: the one that did not send last, if it has a packet waiting."""
        ready = [
            direction
            for direction in (self._last_sender.other, self._last_sender)
            if self._waiting[direction]
        ]
        return min(
            ready, key=lambda direction: max(self._waiting[direction][0][0], self._idle_from), default=None
        )


CONDITIONS: dict[str, tuple[str, Callable[[int], Channel]]] = {
    "a": ("clean loopback", lambda seed: Network(Impairment(seed=seed))),
    "b": ("20 ms, 1 % loss", lambda seed: Network(Impairment(latency=0.020, loss=0.01, seed=seed))),
    "c": ("half-duplex radio, 57,600 baud", lambda seed: Radio(bandwidth=5760, queue=2048)),
    "d": ("20 ms, 10 % loss", lambda seed: Network(Impairment(latency=0.020, loss=0.10, seed=seed))),
}
