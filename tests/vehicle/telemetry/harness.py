"""A vehicle that receives only a test's messages, and a scripted autopilot that answers as the test says."""

from __future__ import annotations

from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import mavstack
from mavstack.dialects import Dialect, common
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import Vehicle, connect
from mavstack.wire import Packet

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from mavstack.dialects import Message

ARDUPILOT, PX4 = common.MavAutopilot.ARDUPILOTMEGA, common.MavAutopilot.PX4
QUADROTOR = common.MavType.QUADROTOR
RESULT = common.MavResult
DIALECT = Dialect.load("all")


class TelemetryHarness:
    """A connection without links, and a vehicle on it, which receive the messages of `receive` only."""

    def __init__(self, node) -> None:
        self.node = node
        self.vehicle = Vehicle(node, node.component(1))

    @property
    def telemetry(self):
        return self.vehicle.telemetry

    def receive(self, *messages: Message, system: int = 1, component: int = 1) -> None:
        for message in messages:
            raw = mavstack.encode(message, system=system, component=component, sequence=0)
            self.receive_packet(Packet(raw, DIALECT))

    def receive_packet(self, packet: Packet) -> None:
        if packet.message_id in self.node._host.discovery.handles:
            self.node._host.discovery.receive(packet, self.node.now())
        self.node._host.receive_packet(packet)

    def heartbeat(self, autopilot=ARDUPILOT, type=QUADROTOR, **fields) -> None:  # noqa: A002
        self.receive(common.Heartbeat(type=type, autopilot=autopilot, **fields))


def with_telemetry(scenario: Callable[[TelemetryHarness], Awaitable[None]]) -> None:
    """Run a scenario in virtual time."""

    async def whole() -> None:
        async with connect() as node:
            await scenario(TelemetryHarness(node))

    run_virtually(whole())


@dataclass
class Peer:
    """A scripted autopilot: sends the messages of `send`, and answers SET_MESSAGE_INTERVAL with `answer`."""

    node: Node
    requested_rates: list[tuple[int, float]] = field(default_factory=list)
    answer: int = RESULT.ACCEPTED
    vehicle: Vehicle = None

    def send(self, *messages: Message) -> None:
        for message in messages:
            self.node.send(message)


@asynccontextmanager
async def peer(
    autopilot: int = ARDUPILOT, others: Callable[[MemoryNetwork], Node] | None = None
) -> AsyncIterator[Peer]:
    """A scripted autopilot and a connection that has received its heartbeat, over a memory link."""
    network = MemoryNetwork()
    async with Node(
        network.link(), system=1, component=1, type=QUADROTOR, autopilot=autopilot, heartbeat=True
    ) as node:
        scripted = Peer(node)

        @node.on_command(common.MavCmd.SET_MESSAGE_INTERVAL)
        def set_interval(request) -> int:
            scripted.requested_rates.append((int(request.command.param1), request.command.param2))
            return scripted.answer

        async with connect(network.link()) as ground:
            scripted.vehicle = await ground.wait_for_vehicle()
            yield scripted


def with_peer(scenario: Callable[[Peer], Awaitable[None]], **options) -> None:
    """Run a scenario with a scripted autopilot in virtual time."""

    async def whole() -> None:
        async with peer(**options) as scripted:
            await scenario(scripted)

    run_virtually(whole())
