"""The table of cases, run against the decision, the engine, the forwarding of a node, and mavlink-router."""

from __future__ import annotations

import asyncio
import select
import socket
from contextlib import ExitStack, contextmanager
from time import monotonic, sleep

import pytest

from mavstack._core import PacketRouter
from mavstack.dialects import common
from mavstack.links import BytesReceived, MemoryNetwork
from mavstack.node import Node
from mavstack.node.forwarding import Forwarding
from mavstack.router import RouterEngine
from mavstack.sim.virtual import run_virtually

from .cases import CASES, ENGINE, MAVLINK_ROUTER, NODE, PURE
from .mavlink_router import running_mavlink_router
from .packets import Packets

TIMEOUT = 10.0
#: Seconds in which packets that should not arrive would have arrived.
SETTLING_TIME = 0.05


def cases(implementation):
    """Return the cases that an implementation can express, as parameters."""
    return [pytest.param(case, id=case.name) for case in CASES if implementation in case.by]


@pytest.mark.parametrize("case", cases(PURE))
def test_the_decision(case):
    router, packets = PacketRouter(common), Packets()
    ports = {letter: router.add_port((case.groups or {}).get(letter)) for letter in case.links}
    letters = {port: letter for letter, port in ports.items()}
    for number, step in enumerate(case.steps):
        reached = router.route(ports[step.link], packets.make(step), number * 0.01)
        assert "".join(sorted(letters[port] for port in reached)) == step.reaches, step


class Ends:
    """The programs at the ends of the links: a socket for each, which sends to a port of the router."""

    def __init__(self, stack, links):
        self.sockets = {letter: open_socket(stack) for letter in links}
        self.routers = {letter: open_socket(stack) for letter in links}

    def send(self, letter, raw):
        self.sockets[letter].sendto(raw, self.routers[letter].getsockname())

    def received(self, raw, count=0):
        """Return the links on which the packet arrived, and nothing else.

        A loaded system delivers a datagram some time after it was sent, so `count` datagrams are waited for.
        """
        deadline = monotonic() + TIMEOUT
        ours = {router.getsockname() for router in self.routers.values()}
        arrived = {letter: list(datagrams(end, ours)) for letter, end in self.sockets.items()}
        while sum(map(len, arrived.values())) < count and monotonic() < deadline:
            select.select(self.sockets.values(), [], [], 0.1)
            for letter, end in self.sockets.items():
                arrived[letter].extend(datagrams(end, ours))
        assert all(datagram == raw for datagrams in arrived.values() for datagram in datagrams)
        return "".join(letter for letter in sorted(arrived) for _ in arrived[letter])


def open_socket(stack):
    opened = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
    opened.bind(("127.0.0.1", 0))
    opened.setblocking(False)
    return opened


def datagrams(end, senders):
    """Yield the datagrams of the senders, not late ones of tests that had the port before."""
    while True:
        try:
            datagram, sender = end.recvfrom(2048)
        except BlockingIOError:
            return
        if sender in senders:
            yield datagram


@contextmanager
def running_engine(case, ends):
    """Run the engine; the context is a function that waits until a packet of a link was routed."""
    counts = dict.fromkeys(case.links, 0)
    with RouterEngine(common) as engine:
        numbers = {}
        for letter in case.links:
            peer = ends.sockets[letter].getsockname()
            numbers[letter] = engine.add_udp(ends.routers[letter].fileno(), name=letter, peer=peer)
            engine.set_group(numbers[letter], (case.groups or {}).get(letter))
        engine.statistics()  # it is answered when all links exist; the first may be read before

        def wait_until_routed(letter):
            counts[letter] += 1
            deadline = monotonic() + TIMEOUT
            while engine.statistics().endpoints[numbers[letter]].received < counts[letter]:
                assert monotonic() < deadline, f"the packet on {letter} was not received"
                sleep(0.0005)

        yield wait_until_routed


@pytest.mark.parametrize("case", cases(ENGINE))
def test_the_engine(case):
    with ExitStack() as stack:
        ends, packets = Ends(stack, case.links), Packets()
        wait_until_routed = stack.enter_context(running_engine(case, ends))
        for step in case.steps:
            ends.send(step.link, raw := packets.make(step))
            wait_until_routed(step.link)
            assert ends.received(raw, len(step.reaches)) == step.reaches, step


class MemoryEnd:
    """The program at the end of a memory link."""

    def __init__(self, letter):
        self.network = MemoryNetwork()
        self.url = f"memory://{letter}"
        self.link = self.network.link(self.url)
        self.data = b""

    async def listen(self):
        async for event in self.link:
            if isinstance(event, BytesReceived):
                self.data += bytes(event.data)

    def other_side(self):
        return self.network.link(self.url)

    def take(self, raw):
        """Return how often a packet arrived since the last call."""
        data, self.data = self.data, b""
        return data.count(raw)


async def run_node_case(case):
    """Run a case: link A, or the links of the group, are those of the node; the others are outputs."""
    ends = {letter: MemoryEnd(letter) for letter in case.links}
    for end in ends.values():
        await end.link.open()
    of_node = [letter for letter in case.links if letter in (case.groups or "A")]
    links = [ends[letter].other_side() for letter in of_node]
    async with Node(*links, heartbeat=False) as node, Forwarding(node) as forwarding:
        tasks = [asyncio.create_task(end.listen()) for end in ends.values()]
        for letter in case.links:
            if letter not in of_node:
                await forwarding.add(ends[letter].other_side())
        await asyncio.sleep(0.1)
        packets = Packets()
        for step in case.steps:
            raw = packets.make(step)
            for channel in ends[step.link].link.channels:
                channel.write(raw)
            await asyncio.sleep(0.01)
            reached = "".join(letter * ends[letter].take(raw) for letter in case.links)
            assert reached == step.reaches, step
        for task in tasks:
            task.cancel()
    for end in ends.values():
        await end.link.close()


@pytest.mark.parametrize("case", cases(NODE))
def test_the_forwarding_of_a_node(case):
    run_virtually(run_node_case(case))


@pytest.mark.interop
@pytest.mark.parametrize("case", cases(MAVLINK_ROUTER))
def test_mavlink_router(case, tmp_path):
    with ExitStack() as stack:
        ends, packets = Ends(stack, case.links), Packets()
        ports = {letter: end.getsockname()[1] for letter, end in ends.routers.items()}
        addresses = {letter: end.getsockname() for letter, end in ends.routers.items()}
        for end in ends.routers.values():
            end.close()
        stack.enter_context(running_mavlink_router(ports, tmp_path))
        for letter, end in ends.sockets.items():
            end.sendto(b"\0", addresses[letter])  # it sends to the last sender
        sleep(SETTLING_TIME)
        for step in case.steps:
            ends.sockets[step.link].sendto(raw := packets.make(step), addresses[step.link])
            sleep(SETTLING_TIME)
            assert ends.received(raw) == step.reaches, step
