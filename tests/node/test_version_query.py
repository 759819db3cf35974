"""A node with the version "auto" asks autopilots that speak MAVLink 1 for their capabilities."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.sim.virtual import run_virtually

MAVLINK2 = common.MavProtocolCapability.MAVLINK2


def versions(node: Node) -> list[int]:
    return [channel.version for channel in node._host.engine.channels]


def autopilot(network: MemoryNetwork, capabilities: int) -> Node:
    node = Node(network.link(), system=1, component=1, type=2, autopilot=12, version=1)
    answer = common.AutopilotVersion(capabilities=capabilities)
    node.publish(common.AutopilotVersion, lambda _: answer)
    return node


@pytest.mark.parametrize(("capabilities", "expected"), [(0, 1), (MAVLINK2, 2)])
def test_the_capability_of_an_autopilot_decides(capabilities, expected) -> None:
    async def work() -> None:
        network = MemoryNetwork()
        async with autopilot(network, capabilities), Node(network.link(), version="auto") as ground:
            await ground.wait_for_autopilot(timeout=3)
            assert versions(ground) == [1]
            await asyncio.sleep(10)
            assert versions(ground) == [expected]

    run_virtually(work())


def test_nothing_is_asked_with_a_fixed_version() -> None:
    async def work() -> None:
        network, asked = MemoryNetwork(), []
        async with autopilot(network, MAVLINK2) as vehicle, Node(network.link()) as ground:
            vehicle.add_listener(common.CommandLong, asked.append)
            await ground.wait_for_autopilot(timeout=3)
            await asyncio.sleep(10)
            assert asked == []

    run_virtually(work())
