"""A vehicle that hears what a test lets it hear, and a peer that answers as a test has it answer."""

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


class Stage:
    """A connection without links, and a vehicle on it; `hear` is all that it ever hears."""

    def __init__(self, node) -> None:
        self.node = node
        self.vehicle = Vehicle(node, node.component(1))

    @property
    def telemetry(self):
        return self.vehicle.telemetry

    def hear(self, *messages: Message, system: int = 1, component: int = 1) -> None:
        for message in messages:
            raw = mavstack.encode(message, system=system, component=component, sequence=0)
            self.hear_packet(Packet(raw, DIALECT))

    def hear_packet(self, packet: Packet) -> None:
        if packet.message_id in self.node._host.discovery.handles:
            self.node._host.discovery.receive(packet, self.node.now())
        self.node._host.packet_dispatch.deliver(packet)

    def heartbeat(self, autopilot=ARDUPILOT, type=QUADROTOR, **fields) -> None:  # noqa: A002
        self.hear(common.Heartbeat(type=type, autopilot=autopilot, **fields))


def on_stage(scenario: Callable[[Stage], Awaitable[None]]) -> None:
    """Run a scenario in virtual time."""

    async def whole() -> None:
        async with connect() as node:
            await scenario(Stage(node))

    run_virtually(whole())


@dataclass
class Peer:
    """A scripted autopilot: sends what `say` is given, and answers SET_MESSAGE_INTERVAL with `answer`."""

    node: Node
    asked: list[tuple[int, float]] = field(default_factory=list)
    answer: int = RESULT.ACCEPTED
    vehicle: Vehicle = None

    def say(self, *messages: Message) -> None:
        for message in messages:
            self.node.send(message)


@asynccontextmanager
async def peer(
    autopilot: int = ARDUPILOT, others: Callable[[MemoryNetwork], Node] | None = None
) -> AsyncIterator[Peer]:
    """A scripted autopilot and a connection that has heard it, over a memory link."""
    network = MemoryNetwork()
    async with Node(
        network.link(), system=1, component=1, type=QUADROTOR, autopilot=autopilot, heartbeat=True
    ) as node:
        here = Peer(node)

        @node.on_command(common.MavCmd.SET_MESSAGE_INTERVAL)
        def set_interval(request) -> int:
            here.asked.append((int(request.command.param1), request.command.param2))
            return here.answer

        async with connect(network.link()) as ground:
            here.vehicle = await ground.wait_for_vehicle()
            yield here


def with_peer(scenario: Callable[[Peer], Awaitable[None]], **options) -> None:
    """Run a scenario with a scripted autopilot in virtual time."""

    async def whole() -> None:
        async with peer(**options) as here:
            await scenario(here)

    run_virtually(whole())
