"""The settings of link URLs, applied by a node."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, LinkURLError, SigningError
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.node.forwarding import Forwarding
from mavstack.security import SigningKey
from mavstack.services import Address
from mavstack.sim.virtual import run_virtually


def test_the_url_gives_the_address_of_the_node() -> None:
    assert Node("udpin://127.0.0.1:0?id=245/191").address == Address(245, 191)
    assert Node("udpin://127.0.0.1:0?id=245", system=7, component=8).address == Address(245, 8)
    assert Node("udpin://127.0.0.1:0", "udpin://127.0.0.1:0?id=245").address == Address(245, 190)


@pytest.mark.parametrize("option", ["id", "heartbeat_rate"])
def test_urls_that_contradict_each_other_are_refused(option) -> None:
    with pytest.raises(InvalidArgumentError, match=f"must agree on the option {option}"):
        Node(*(f"udpin://127.0.0.1:0?{option}={value}" for value in (1, 2)))


@pytest.mark.parametrize(
    "options", [{"version": 3}, {"heartbeat_rate": -1.0}, {"heartbeat_rate": float("inf")}, {"system": 0}]
)
def test_invalid_arguments_are_refused(options) -> None:
    with pytest.raises(InvalidArgumentError):
        Node(**options)


@pytest.mark.parametrize(
    ("query", "expected"), [("", 10), ("?heartbeat_rate=4", 40), ("?heartbeat_rate=0", 0)]
)
def test_the_rate_of_heartbeats(query, expected) -> None:
    async def work() -> None:
        network = MemoryNetwork()
        async with Node(network.link("memory://net"), system=2, heartbeat=False) as other:
            node = Node(network.link(f"memory://net{query}"))
            count = 0

            def counted(_: object) -> None:
                nonlocal count
                count += 1

            other.add_listener(common.Heartbeat, counted, system=255)
            async with node:
                await asyncio.sleep(9.95)
            assert count == pytest.approx(expected, abs=1)

    run_virtually(work())


@pytest.mark.usefixtures("clock")
def test_each_link_signs_with_the_key_of_its_url(tmp_path) -> None:
    """Two vehicles have keys of their own; each is reached over its own link."""

    async def work() -> None:
        networks, keys = (MemoryNetwork(), MemoryNetwork()), (SigningKey.generate(), SigningKey.generate())
        for number, key in enumerate(keys):
            key.save(tmp_path / f"{number}.key")
        links = [
            network.link(f"memory://net?signing_key={tmp_path}/{number}.key")
            for number, network in enumerate(networks)
        ]
        vehicles = [
            Node(
                network.link("memory://net"), system=number + 1, component=1, type=2, autopilot=3, signing=key
            )
            for number, (network, key) in enumerate(zip(networks, keys, strict=True))
        ]
        async with vehicles[0], vehicles[1], Node(*links) as ground:
            for number in (1, 2):
                await (await ground.wait_for_autopilot(number, timeout=3)).ping(timeout=20)
            assert [channel.verifies for channel in ground._host.engine.channels] == [True, True]

    run_virtually(work())


def test_a_missing_key_raises_when_the_node_is_created(tmp_path) -> None:
    with pytest.raises(SigningError, match="cannot read the key file"):
        Node(f"udpin://127.0.0.1:0?signing_key={tmp_path}/none.key")


async def test_an_output_has_no_settings_of_its_own() -> None:
    async with Node(MemoryNetwork().link()) as node, Forwarding(node) as forwarding:
        with pytest.raises(LinkURLError, match="forwarded unchanged, so that the option signing_key has no"):
            await forwarding.add("udpin://127.0.0.1:0?signing_key=fleet")
