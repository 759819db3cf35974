"""The keys of two nodes, in virtual time: installed, refused, removed, and kept over reconnects."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import RemoteDenied, RemoteTimeout
from mavstack.node import Node
from mavstack.services.signing_setup import KeySettled, SigningSetupServer
from mavstack.services.signing_setup.key_change import signed_with
from mavstack.sim.virtual import run_virtually
from mavstack.wire import Encoder
from tests.node.signed_pair import (
    CHANGES,
    NEW,
    OLD,
    PX4,
    START,
    THIRD,
    SignedPair,
    assert_both_use,
    receive_packets,
    refusals,
)

pytestmark = pytest.mark.usefixtures("clock")


@pytest.mark.parametrize(("old", "new"), CHANGES)
def test_both_nodes_use_an_installed_key_also_after_reconnects(old, new) -> None:
    async def work() -> None:
        async with SignedPair(old) as pair:
            await assert_both_use(pair, old)
            async with pair.vehicle.events(KeySettled) as settled:
                await pair.setup_signing(new)
                (event,) = settled.drain()
                assert (event.key, event.changed) == (new, True)
            await assert_both_use(pair, new)
            for _ in range(2):
                await pair.reconnect()
                await assert_both_use(pair, new, seconds=0.1)  # heartbeats are sent immediately
                assert [refusals(node) for node in pair.nodes] == [0, 0]

    run_virtually(work())


@pytest.mark.parametrize("old", [None, OLD])
def test_a_refused_key_changes_nothing(old) -> None:
    async def work() -> None:
        async with SignedPair(old, trusted=False) as pair:
            with pytest.raises(RemoteDenied, match="setting a signing key on 1/1 failed"):
                await pair.setup_signing(NEW)
            await assert_both_use(pair, old)
            await pair.reconnect()
            await assert_both_use(pair, old, seconds=0.1)
            assert pair.server.key == old

    run_virtually(work())


def test_a_key_of_one_channel_is_not_used_on_others() -> None:
    """A key shared with one vehicle is not used with others."""

    async def work() -> None:
        async with (
            SignedPair() as pair,
            Node(pair.network.link(), system=2, component=1, autopilot=PX4) as other,
        ):
            await asyncio.sleep(1)
            pair.trust()
            await pair.setup_signing(NEW)
            from_ground = [packet for packet in await receive_packets(other) if packet.system == 255]
            assert from_ground
            assert not any(packet.signed for packet in from_ground)
            from_other = [packet for packet in await receive_packets(pair.ground) if packet.system == 2]
            assert from_other

    run_virtually(work())


def test_a_key_installed_on_a_node_applies_to_all_its_channels() -> None:
    """A key installed over the cable applies to the radio too, and to channels that open later."""

    async def work() -> None:
        async with SignedPair() as pair, Node(pair.network.link(), system=9) as other:
            await asyncio.sleep(1)
            pair.trust()
            await pair.setup_signing(NEW)
            async with Node(pair.network.link(), system=10) as late:
                for node in (other, late):
                    packets = [packet for packet in await receive_packets(node) if packet.system == 1]
                    assert packets
                    assert all(signed_with(packet, NEW, START) for packet in packets)
                assert {packet.system for packet in await receive_packets(pair.vehicle)} == {255}
            channels = pair.vehicle._host.engine.channels
            assert len({channel.signing.link_id for channel in channels}) == len(channels)
            await pair.setup_signing(None)
            assert {packet.system for packet in await receive_packets(pair.vehicle)} == {9, 255}

    run_virtually(work())


def test_the_later_of_two_keys_applies() -> None:
    """The ground station installs a key on the vehicle, then the vehicle another on the ground station."""

    async def work() -> None:
        async with SignedPair() as pair:
            server = SigningSetupServer(pair.ground.address, may_set=lambda _: None)
            pair.ground.serve(server)
            await pair.setup_signing(NEW)
            await pair.vehicle.component(*pair.ground.address).setup_signing(THIRD)
            for _ in range(2):
                await assert_both_use(pair, THIRD)
                await pair.reconnect()

    run_virtually(work())


def test_only_radio_status_is_accepted_unsigned() -> None:
    async def work() -> None:
        async with SignedPair(OLD) as pair:
            radio = Encoder(51, 68)
            (channel,) = pair.vehicle_link.channels
            async with pair.vehicle.packets(system=51) as packets:
                for message in (common.RadioStatus(txbuf=50), common.Heartbeat(), common.SystemTime()):
                    channel.receive(radio.encode(message, START))
                await asyncio.sleep(0.1)
                assert [packet.name for packet in packets.drain()] == ["RADIO_STATUS"]
            assert pair.vehicle._host.engine.channels[0].signing.refusals.unsigned == 2

    run_virtually(work())


@pytest.mark.parametrize(("ground", "vehicle"), [(None, OLD), (NEW, OLD)])
def test_packets_with_another_key_are_refused(ground, vehicle) -> None:
    async def work() -> None:
        async with SignedPair(ground, vehicle_key=vehicle) as pair:
            with pytest.raises(RemoteTimeout):
                await pair.setup_signing(None, timeout=5)
            assert await receive_packets(pair.vehicle) == []
            assert pair.server.key == OLD

    run_virtually(work())
