"""A radio network: one ground station, several vehicles, one half-duplex channel that all of them share.

All vehicles receive the packets of the ground station, and it receives theirs. Each radio has a queue that
drops what overflows, and reports its free part to its own node at intervals (RADIO_STATUS).
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

    def __init__(self, medium: SharedMedium) -> None:
        self.receivers: list[Radio] = []
        self.received: list[tuple[float, bytes]] = []
        self.overflowed = 0
        self._medium = medium
        self._queued: list[tuple[float, int]] = []  # (when its last byte leaves, size)
        self._status_due = START + STATUS_INTERVAL if medium.sends_status else float("inf")
        self._encoder = Encoder(*RADIO)

    def send(self, data: bytes, now: float) -> None:
        if self.waiting(now) + len(data) > self._medium.queue:
            self.overflowed += 1
            return
        leaves = self._medium.transmit(len(data), now)
        self._queued.append((leaves, len(data)))
        for other in self.receivers:
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
            free = round(100 * (1 - self.waiting(now) / self._medium.queue))
            arrived.append(self._encoder.encode(common.RadioStatus(rssi=200, txbuf=free), now))
        return arrived

    def next_timeout(self) -> float | None:
        due = self.received[0][0] if self.received else self._status_due
        return min(due, self._status_due)


class ReceiveOnly:
    """The outward pipe of a port that only receives."""

    def send(self, data: bytes, now: float) -> None:
        """The other port has sent it."""

    def next_timeout(self) -> float | None:
        return None


class SharedMedium:
    """The radio frequency that all radios share."""

    def __init__(self, bandwidth: float = 5760.0, queue: int = 2048, *, sends_status: bool = True) -> None:
        self.bandwidth, self.queue, self.sends_status = bandwidth, queue, sends_status
        self.free_at = START
        self.carried = 0

    def transmit(self, size: int, now: float) -> float:
        self.carried += size
        self.free_at = max(self.free_at, now) + size / self.bandwidth
        return self.free_at


def radio_network(
    network: Network, medium: SharedMedium, ground: Node, vehicles: list[Node], share: float | None = None
) -> list[Radio]:
    """Give each node a radio.

    `share` is the bandwidth configured for a vehicle's channel; the ground station's is three times that.
    """
    base = Radio(medium)
    radios = [base]
    ground.ports.append(
        Port(ground, ground.engine.open_channel("radio", bandwidth=share and 3 * share), base, base)
    )
    for vehicle in vehicles:
        radio = Radio(medium)
        radio.receivers = [base]
        base.receivers.append(radio)
        channel = vehicle.engine.open_channel("radio", bandwidth=share)
        vehicle.ports.append(Port(vehicle, channel, radio, radio))
        radios.append(radio)
    return radios


def call_every(network: Network, seconds: float, action: Callable[[], None]) -> None:
    """Call `action` after every `seconds`."""

    def call() -> None:
        action()
        network.at(seconds, call)

    network.at(seconds, call)
