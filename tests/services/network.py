"""A simulated network: engines joined by impaired pipes, in virtual time, from one seed.

Everything runs as it does over real links (bytes, checksums, routes, pace, services); only the sockets and
the clock are missing. A scenario is a function of a seed that raises AssertionError; `seeds.check(scenario)`
runs it over many, and `pytest TEST --seed N` runs it again over the one that failed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import count
from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.links import Flow, Impairment
from mavstack.node.engine import Engine
from mavstack.services import Address

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node.channel_state import ChannelState
    from mavstack.services import Event, Service
    from mavstack.wire import Packet

GROUND = Address(255, 190)
VEHICLE = Address(1, 1)
START = 1_700_000_000.0


class HalfDuplexRadio:
    """A half-duplex radio: both directions share its bandwidth; each has a queue that drops the overflow."""

    def __init__(self, bandwidth: float = 5760.0, queue: int = 2048, latency: float = 0.01) -> None:
        self.bandwidth, self.queue, self.latency = bandwidth, queue, latency
        self.free_at = START
        self.carried = 0
        self.overflowed = 0
        self._directions = [[], []]  # queued (end of transmission, size), per direction

    def depart(self, direction: int, size: int, now: float) -> float | None:
        waiting = self.waiting(direction, now)
        if waiting and waiting + size > self.queue:
            self.overflowed += 1
            return None
        self.free_at = max(self.free_at, now) + size / self.bandwidth
        self._directions[direction].append((self.free_at, size))
        self.carried += size
        return self.free_at

    def waiting(self, direction: int, now: float) -> int:
        queued = [item for item in self._directions[direction] if item[0] > now]
        self._directions[direction] = queued
        return sum(size for _, size in queued)

    def free_percent(self, direction: int, now: float) -> int:
        return round(100 * (1 - min(self.waiting(direction, now), self.queue) / self.queue))


class Pipe:
    """One direction between two engines."""

    def __init__(
        self, impairment: Impairment, name: str, radio: HalfDuplexRadio | None, direction: int
    ) -> None:
        self.flow = Flow(impairment, name)
        self.cut = False
        self._radio, self._direction = radio, direction
        self._in_transit: list[tuple[float, bytes]] = []

    def send(self, data: bytes, now: float) -> None:
        if self.cut:
            return
        if self._radio is None:
            self.flow.send(data, now)
            return
        departure = self._radio.depart(self._direction, len(data), now)
        if departure is not None:
            self._in_transit.append((departure + self._radio.latency, data))

    def receive(self, now: float) -> list[bytes]:
        while self._in_transit and self._in_transit[0][0] <= now:
            due, data = self._in_transit.pop(0)
            self.flow.send(data, due)
        arrived = self.flow.receive(now)
        return [] if self.cut else arrived

    def drop(self) -> None:
        """Lose everything that is on its way."""
        self._in_transit.clear()
        self.flow.receive(math.inf)

    def next_timeout(self) -> float | None:
        times = [time for time in (self.flow.next_timeout(),) if time is not None]
        times += [due for due, _ in self._in_transit[:1]]
        return min(times, default=None)


@dataclass
class Port:
    """An engine's end of a link: bytes leave by one pipe and arrive by the other."""

    node: Node
    channel: ChannelState
    outward: Pipe
    inward: Pipe


class Node:
    """An engine in the network; `setup` builds its services, again after each restart."""

    def __init__(self, network: Network, address: Address, setup: Callable[[Engine], None] | None) -> None:
        self.network = network
        self.address = address
        self.setup = setup
        self.engine = Engine(address, common)
        self.ports: list[Port] = []
        #: It does nothing, and what is sent to it waits.
        self.is_suspended = False
        self.received: list[Packet] = []
        self.events: list[tuple[Service, Event]] = []
        if setup:
            setup(self.engine)

    def events_of(self, kind: type) -> list[Event]:
        return [event for _, event in self.events if isinstance(event, kind)]

    def unplug(self, port: Port) -> None:
        """Close this end of a link; what was on its way to it is lost."""
        self.engine.close_channel(port.channel)
        port.inward.drop()
        port.inward.cut = True

    def plug(self, port: Port) -> None:
        """Open this end of a link again."""
        port.channel = self.engine.open_channel("wire")
        port.inward.cut = False

    def restart(self) -> None:
        """Reboot: lose everything except the objects that `setup` closes over."""
        self.engine = Engine(self.address, common)
        for port in self.ports:
            port.channel = self.engine.open_channel(port.channel.name)
        if self.setup:
            self.setup(self.engine)

    def receive(self, now: float) -> None:
        for port in self.ports:
            for data in port.inward.receive(now):
                packets = self.engine.receive(port.channel, data, now)
                if self.network.keep_packets:
                    self.received += packets

    def send(self, now: float) -> bool:
        data = self.engine.data_to_send(now)
        for channel, chunk in data:
            for port in self.ports:
                if port.channel is channel:
                    port.outward.send(chunk, now)
        self.events += self.engine.events()
        return bool(data)


class Network:
    """Nodes, the links between them, and the virtual time."""

    def __init__(self, seed: int = 0, *, keep_packets: bool = False) -> None:
        self.now = START
        self.seed = seed
        self.random = Random(seed)
        self.keep_packets = keep_packets
        self.nodes: list[Node] = []
        self._actions: list[tuple[float, int, Callable[[], None]]] = []
        self._order = count()

    def node(self, address: Address, setup: Callable[[Engine], None] | None = None) -> Node:
        node = Node(self, address, setup)
        self.nodes.append(node)
        return node

    def connect(
        self,
        one: Node,
        other: Node,
        impairment: Impairment | None = None,
        *,
        radio: HalfDuplexRadio | None = None,
        bandwidth: float | None = None,
    ) -> tuple[Pipe, Pipe]:
        """Join two nodes; `bandwidth` is the one that both have configured."""
        model = replace(impairment or Impairment(), seed=self.seed)
        number = next(self._order)
        known = {"bandwidth": bandwidth, "half_duplex": radio is not None}
        there, back = Pipe(model, f"{number} there", radio, 0), Pipe(model, f"{number} back", radio, 1)
        one.ports.append(Port(one, one.engine.open_channel("wire", **known), there, back))
        other.ports.append(Port(other, other.engine.open_channel("wire", **known), back, there))
        return there, back

    def at(self, delay: float, action: Callable[[], None]) -> None:
        """Call `action` in `delay` seconds."""
        self._actions.append((self.now + delay, next(self._order), action))
        self._actions.sort()

    def run(self, until: Callable[[], bool] = lambda: False, *, timeout: float = 600.0) -> bool:
        """Advance the time until `until()` is true; return False if it is not within `timeout` seconds."""
        end, stuck = self.now + timeout, 0
        while True:
            self._pump()
            if until():
                return True
            due = self._next_timeout()
            if due is None or due > end:
                self.now = end
                return until()
            stuck = 0 if due > self.now else stuck + 1
            assert stuck < 10_000, "time stands still: a timer stays due"
            self.now = max(due, self.now)

    def _pump(self) -> None:
        while self._actions and self._actions[0][0] <= self.now:
            self._actions.pop(0)[2]()
        running = [node for node in self.nodes if not node.is_suspended]
        for node in running:
            node.receive(self.now)
            node.engine.handle_timeout(self.now)
        for node in running:
            node.send(self.now)

    def _next_timeout(self) -> float | None:
        running = [node for node in self.nodes if not node.is_suspended]
        times = [node.engine.next_timeout() for node in running]
        times += [port.inward.next_timeout() for node in running for port in node.ports]
        times += [action[0] for action in self._actions[:1]]
        return min((time for time in times if time is not None), default=None)


def random_impairment(random: Random, *, worst_loss: float = 0.4) -> Impairment:
    """Draw the impairments of a link: some seeds are clean, some lose a large share of the packets."""
    latency = random.choice([0.0, 0.002, 0.02, 0.2])
    return Impairment(
        loss=random.choice([0.0, 0.01, 0.1, 0.2, random.uniform(0, worst_loss)]),
        duplicate=random.choice([0.0, 0.0, 0.05, 0.3]),
        reorder=random.choice([0.0, 0.0, 0.05, 0.2]),
        corrupt=random.choice([0.0, 0.0, 0.0, 0.001]),
        latency=latency,
        jitter=random.choice([0.0, latency / 2]),
        hold=random.choice([0.02, 0.1]),
        bandwidth=random.choice([0.0, 0.0, 20_000.0, 5_760.0]),
        queue=random.choice([2048, 1 << 16]),
    )


def with_cuts(network: Network, pipes: tuple[Pipe, Pipe], *, within: float = 5.0) -> None:
    """Cut both directions once or twice for up to two seconds."""

    def cut(state: bool) -> None:
        for pipe in pipes:
            pipe.cut = state

    for _ in range(network.random.choice([0, 0, 1, 2])):
        begin = network.random.uniform(0, within)
        network.at(begin, lambda: cut(True))
        network.at(begin + network.random.uniform(0.05, 2.0), lambda: cut(False))
