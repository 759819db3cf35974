"""A radio network: one ground station, several vehicles, one half-duplex channel that all of them share.

All vehicles receive the packets of the ground station, and it receives theirs. Each radio has a queue that
drops what overflows, and tells its own side once in a while how much of it is free (RADIO_STATUS).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.wire import Encoder
from tests.services.network import START, Network, Node, Port

if TYPE_CHECKING:
    from collections.abc import Callable

RADIO = (51, 68)
STATUS_INTERVAL = 1.0


class Radio:
    """One node's radio: its queue, its transmissions, and what it has received."""

    def __init__(self, ether: Ether) -> None:
        self.heard_by: list[Radio] = []
        self.received: list[tuple[float, bytes]] = []
        self.overflowed = 0
        self._ether = ether
        self._queued: list[tuple[float, int]] = []  # (when its last byte leaves, size)
        self._status_due = START + STATUS_INTERVAL if ether.tells_status else float("inf")
        self._encoder = Encoder(*RADIO)

    def send(self, data: bytes, now: float) -> None:
        if self.waiting(now) + len(data) > self._ether.queue:
            self.overflowed += 1
            return
        leaves = self._ether.transmit(len(data), now)
        self._queued.append((leaves, len(data)))
        for other in self.heard_by:
            other.received.append((leaves + 0.005, data))
            other.received.sort()

    def waiting(self, now: float) -> int:
        self._queued = [item for item in self._queued if item[0] > now]
        return sum(size for _, size in self._queued)

    def receive(self, now: float) -> list[bytes]:
        arrived = [data for due, data in self.received if due <= now]
        self.received = [item for item in self.received if item[0] > now]
        if now >= self._status_due:
            self._status_due += STATUS_INTERVAL
            free = round(100 * (1 - self.waiting(now) / self._ether.queue))
            arrived.append(self._encoder.encode(common.RadioStatus(rssi=200, txbuf=free), now))
        return arrived

    def next_timeout(self) -> float | None:
        due = self.received[0][0] if self.received else self._status_due
        return min(due, self._status_due)


class Silence:
    """The way out of a port that only receives."""

    def send(self, data: bytes, now: float) -> None:
        """The other port has sent it."""

    def next_timeout(self) -> float | None:
        return None


class Ether:
    """The air that all radios share."""

    def __init__(self, bandwidth: float = 5760.0, queue: int = 2048, *, tells_status: bool = True) -> None:
        self.bandwidth, self.queue, self.tells_status = bandwidth, queue, tells_status
        self.free_at = START
        self.carried = 0

    def transmit(self, size: int, now: float) -> float:
        self.carried += size
        self.free_at = max(self.free_at, now) + size / self.bandwidth
        return self.free_at


def radio_network(
    network: Network, ether: Ether, ground: Node, vehicles: list[Node], share: float | None = None
) -> list[Radio]:
    """Give each node a radio; `share` is what a vehicle knows that it may use, the ground that of three."""
    base = Radio(ether)
    radios = [base]
    ground.ports.append(
        Port(ground, ground.engine.open_channel("radio", bandwidth=share and 3 * share), base, base)
    )
    for vehicle in vehicles:
        radio = Radio(ether)
        radio.heard_by = [base]
        base.heard_by.append(radio)
        channel = vehicle.engine.open_channel("radio", bandwidth=share)
        vehicle.ports.append(Port(vehicle, channel, radio, radio))
        radios.append(radio)
    return radios


def every(network: Network, seconds: float, action: Callable[[], None]) -> None:
    """Do something again and again."""

    def again() -> None:
        action()
        network.at(seconds, again)

    network.at(seconds, again)
