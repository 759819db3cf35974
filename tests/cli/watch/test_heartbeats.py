"""The heartbeats of `mav watch --heartbeat`."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.cli.watch.heartbeats import send_heartbeats
from mavstack.cli.watch.link_follower import Follower
from mavstack.cli.watch.observer import Observer
from mavstack.dialects import Dialect, common
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.security import SigningKey
from mavstack.sim.virtual import run_virtually


def heard_from(query: str = "", **vehicle) -> list:
    """The packets that a vehicle receives in ten seconds from a watched link."""
    heard: list = []

    async def work() -> None:
        network = MemoryNetwork()
        link = network.link(f"memory://net{query}")
        async with Node(network.link("memory://net"), system=1, component=1, type=2, **vehicle) as node, link:
            node.add_packet_listener(None, heard.append)
            follower = Follower(Observer(Dialect.load("all")))
            task = asyncio.create_task(send_heartbeats(link, follower))
            await follower.follow(link, 9.9)
            task.cancel()

    run_virtually(work())
    return heard


def test_heartbeats_are_those_of_a_ground_station() -> None:
    heard = heard_from()
    assert len(heard) == pytest.approx(10, abs=1)
    assert heard[0].message.type == common.MavType.GCS
    assert {(packet.system, packet.component, packet.version) for packet in heard} == {(255, 190, 2)}
    assert [packet.sequence for packet in heard] == list(range(len(heard)))


def test_the_options_of_the_link_apply() -> None:
    heard = heard_from("?id=245/191&mavlink=1&heartbeat_rate=2")
    assert len(heard) == pytest.approx(20, abs=1)
    assert {(packet.system, packet.component, packet.version) for packet in heard} == {(245, 191, 1)}
    assert heard_from("?heartbeat_rate=0") == []


def test_auto_speaks_the_version_of_the_vehicle() -> None:
    assert {packet.version for packet in heard_from("?mavlink=auto", version=1)[1:]} == {1}
    assert {packet.version for packet in heard_from("?mavlink=auto", version=2)} == {2}


def test_heartbeats_are_signed_with_the_key_of_the_link(tmp_path) -> None:
    key = SigningKey.generate()
    key.save(tmp_path / "fleet.key")
    heard = heard_from(f"?signing_key={tmp_path}/fleet.key", signing=key)
    assert heard
    assert all(packet.signed for packet in heard)
