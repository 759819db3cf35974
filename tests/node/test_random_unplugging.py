"""Vehicles that are ended and suspended, and links that are unplugged, at random moments.

In virtual time every operation ends, and the next one after the disturbances succeeds. In real time, with
both readers, the packets of a connection arrive completely and in order, and everybody is heard again.
"""

from __future__ import annotations

import asyncio
import signal
import sys
from asyncio.subprocess import Process, create_subprocess_exec
from collections import defaultdict
from itertools import count
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.errors import ParameterTimeout
from mavstack.node import Node
from mavstack.services.heartbeat import ComponentFound, ComponentLost, Discovery, HeartbeatSender
from mavstack.services.parameters import Encoding, ParameterClient, ParameterServer
from tests.services.network import GROUND, VEHICLE, Network, random_impairment
from tests.services.parameters.harness import any_table, table_of, values_of
from tests.waiting import wait_until

if TYPE_CHECKING:
    from mavstack.wire import Packet
    from tests.seeds import Seeds
    from tests.services.network import Port

LINKS = 3
#: Virtual seconds with disturbances, and the longest time of one disturbance.
DISTURBED = 15.0
MAX_DISTURBANCE = 5.0


# In virtual time


class Disturbances:
    """A vehicle and a ground station with several links, to which things happen at random moments."""

    def __init__(self, seed: int) -> None:
        self.network = Network(seed)
        self.random = Random(seed)
        self.rows = any_table(self.random, 12, Encoding.BYTEWISE)
        self.vehicle = self.network.node(VEHICLE, self._setup)
        self.ground = self.network.node(GROUND, lambda engine: engine.add(HeartbeatSender(GROUND)))
        self.ground.engine.add(Discovery(GROUND, channel_name=self.ground.engine.arrival_channel))
        self.client = self.ground.engine.add(ParameterClient(GROUND, VEHICLE))
        self.unplugged: list[Port] = []
        for _ in range(LINKS):
            self.network.connect(self.ground, self.vehicle, random_impairment(self.random, worst_loss=0.2))
        for _ in range(8):
            begin = self.random.uniform(0, DISTURBED)
            end = begin + self.random.uniform(0.01, MAX_DISTURBANCE)
            self.random.choice((self._unplug, self._suspend, self._cut, self._end))(begin, end)

    def _setup(self, engine) -> None:
        self.server = engine.add(ParameterServer(VEHICLE, Encoding.BYTEWISE))
        for name, value, kind in self.rows:
            self.server.add(name, value, kind)
        engine.add(HeartbeatSender(VEHICLE, common.MavType.QUADROTOR, common.MavAutopilot.PX4))

    def _unplug(self, begin: float, end: float) -> None:
        port = self.random.choice(self.ground.ports)

        def unplug() -> None:
            if port not in self.unplugged:
                self.unplugged.append(port)
                self.ground.unplug(port)

        def plug() -> None:
            if port in self.unplugged:
                self.unplugged.remove(port)
                self.ground.plug(port)

        self.network.at(begin, unplug)
        self.network.at(end, plug)

    def _suspend(self, begin: float, end: float) -> None:
        self.network.at(begin, lambda: setattr(self.vehicle, "is_suspended", True))
        self.network.at(end, lambda: setattr(self.vehicle, "is_suspended", False))

    def _cut(self, begin: float, end: float) -> None:
        pipe = self.random.choice(self.vehicle.ports).inward
        self.network.at(begin, lambda: setattr(pipe, "cut", True))
        self.network.at(end, lambda: setattr(pipe, "cut", False))

    def _end(self, begin: float, end: float) -> None:
        self.network.at(begin, self.vehicle.restart)

    def download(self, timeout: float):
        """Download the parameters; return the ended operation."""
        operation = self.client.download(self.network.now)
        self.ground.engine.touch(self.client)
        assert self.network.run(lambda: operation.done, timeout=timeout)
        return operation


def survive_disturbances(seed: int) -> None:
    case = Disturbances(seed)
    network, engine = case.network, case.ground.engine
    begin = network.now
    while network.now < begin + DISTURBED:
        operation = case.download(timeout=60)
        assert operation.error is None or isinstance(operation.error, ParameterTimeout)
        network.run(timeout=case.random.uniform(0.1, 3))
    network.run(timeout=max(0.0, begin + DISTURBED + MAX_DISTURBANCE - network.now))
    assert not case.unplugged
    assert {*engine.channels} == {port.channel for port in case.ground.ports}
    assert len(engine.channels) == LINKS
    network.run(timeout=5)
    found, lost = (len(case.ground.events_of(kind)) for kind in (ComponentFound, ComponentLost))
    assert found - lost <= 1
    assert set(engine.routes.heard_on(VEHICLE)) <= set(engine.channels)
    assert values_of(case.download(timeout=120).result()) == table_of(case.server)


def test_every_operation_ends_and_the_next_one_succeeds(seeds: Seeds) -> None:
    seeds.check(survive_disturbances)


# In real time


class Craft:
    """A vehicle in a separate process, with one kind of link to the node."""

    def __init__(self, kind: str, address: str, system: int) -> None:
        self.kind, self.address, self.system = kind, address, system
        self.process: Process | None = None
        self.is_suspended = False
        self._lives = count()

    async def start(self) -> None:
        arguments = (self.kind, self.address, str(self.system), str(next(self._lives)))
        self.process = await create_subprocess_exec(
            *(sys.executable, "-m", "tests.node.telemetry_sender", *arguments),
            cwd=Path(__file__).parents[2],
        )

    async def end(self) -> None:
        assert self.process is not None
        self.process.kill()
        await self.process.wait()
        self.is_suspended = False

    def suspend(self) -> None:
        assert self.process is not None
        self.process.send_signal(signal.SIGCONT if self.is_suspended else signal.SIGSTOP)
        self.is_suspended = not self.is_suspended


class Log:
    """The numbers of the packets of each connection, in the order of their arrival."""

    def __init__(self, node: Node) -> None:
        self.numbers: dict[tuple[int, int, int], list[int]] = defaultdict(list)
        self.counts = defaultdict(int)
        node.add_packet_listener(common.DebugVect, self._add)

    def _add(self, packet: Packet) -> None:
        message = packet.message
        self.counts[packet.system] += 1
        self.numbers[packet.system, message.time_usec, int(message.x)].append(int(message.y))

    def check(self, craft: Craft) -> None:
        """Packets are in order; of a stream that the node keeps open none is missing."""
        for (system, *_), numbers in self.numbers.items():
            if system == craft.system and craft.kind in ("tcp", "unix"):
                assert numbers == list(range(len(numbers)))
            elif system == craft.system:
                assert numbers == sorted(set(numbers))


async def open_links(node: Node, folder: Path) -> list[Craft]:
    """Open a link of each kind, with its vehicle."""
    options = "wait=yes&retry=0.02&retry_limit=0.05"
    links = {
        "udp": await node.add_link("udpin://127.0.0.1:0?idle=1"),
        "tcp": await node.add_link("tcpin://127.0.0.1:0"),
        "unix": await node.add_link(f"unix://{folder}/s?{options}"),
        "serial": await node.add_link(f"serial://{folder}/tty?{options}"),
    }
    crafts = []
    for number, (kind, link) in enumerate(links.items(), 1):
        address = {"unix": f"{folder}/s", "serial": f"{folder}/tty"}.get(kind) or str(link.address[1])
        crafts.append(Craft(kind, address, number))
    return crafts


def unplug(node: Node, craft: Craft) -> None:
    """Close the channel on which a vehicle is heard."""
    for link in node.links:
        for channel in link.channels:
            if (craft.system, 1) in node.channel_state(channel).parser.sources:
                channel.close()


async def heard_again(log: Log, craft: Craft) -> None:
    before = log.counts[craft.system]
    await wait_until(lambda: log.counts[craft.system] > before + 5, f"packets of {craft.kind}")


def descriptors() -> int:
    return len([*Path("/proc/self/fd").iterdir()])


@pytest.mark.skipif(sys.platform != "linux", reason="counts descriptors in /proc, and uses pseudo-terminals")
@pytest.mark.parametrize("reader", ["native", "asyncio"])
@pytest.mark.parametrize("seed", [1, 2])
async def test_vehicles_that_are_ended_suspended_and_unplugged_are_heard_again(
    reader, seed, tmp_path, monkeypatch
):
    pytest.importorskip("serial")
    monkeypatch.setenv("MAVSTACK_INPUT", reader)
    random, before = Random(seed), descriptors()
    async with Node(heartbeat=False) as node:
        assert (node._host.driver.native is not None) == (reader == "native")
        crafts, log = await open_links(node, tmp_path), Log(node)
        for craft in crafts:
            await craft.start()
        for craft in crafts:
            await heard_again(log, craft)
        for _ in range(10):
            craft = random.choice(crafts)
            match random.choice(["end", "suspend", "unplug"]):
                case "end":
                    await craft.end()
                    await craft.start()
                case "suspend":
                    craft.suspend()
                case "unplug":
                    unplug(node, craft)
            await asyncio.gather(*[heard_again(log, each) for each in crafts if not each.is_suspended])
        for craft in crafts:
            if craft.is_suspended:
                craft.suspend()
                await heard_again(log, craft)
            await craft.end()
            log.check(craft)
        assert node.component(1) is not None
    assert descriptors() == before
