"""Links that are added to a node and removed from it."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, LinkError
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.services.heartbeat import ComponentLost
from mavstack.sim.virtual import run_virtually

QUADROTOR, PX4 = common.MavType.QUADROTOR, common.MavAutopilot.PX4


def test_a_link_of_an_open_node_is_added_and_removed() -> None:
    async def work() -> None:
        network = MemoryNetwork()
        vehicle = Node(network.link(), system=7, component=1, type=QUADROTOR, autopilot=PX4)
        async with vehicle, Node() as ground, ground.events(ComponentLost) as lost:
            link = await ground.add_link(network.link())
            found = await ground.wait_for_autopilot(7, timeout=5)
            await found.ping()
            assert ground.links == [link]
            await ground.remove_link(link)
            assert (ground.links, link.closed) == ([], True)
            async with asyncio.timeout(5):
                assert (await anext(lost)).component.address == (7, 1)
            with pytest.raises(InvalidArgumentError, match="the node has no link"):
                await ground.remove_link(link)

    run_virtually(work())


def test_a_link_of_a_closed_node_opens_with_it() -> None:
    async def work() -> None:
        network = MemoryNetwork()
        node = Node()
        link = await node.add_link(network.link())
        async with node:
            assert link.channels is not None
        assert link.closed

    run_virtually(work())


@pytest.mark.parametrize(
    ("url", "error", "text"),
    [
        ("udpin://127.0.0.1:0?id=7", InvalidArgumentError, "the address of the node is 255/190"),
        (
            "udpin://127.0.0.1:0?heartbeat_rate=2",
            InvalidArgumentError,
            "only for the links that a node begins",
        ),
        ("udpin://192.0.2.1:1", LinkError, "cannot open"),
        ("nonsense", LinkError, "nonsense"),
    ],
)
async def test_a_link_that_cannot_be_added(url: str, error: type[Exception], text: str) -> None:
    async with Node() as node:
        with pytest.raises(error, match=text):
            await node.add_link(url)
        assert node.links == []
