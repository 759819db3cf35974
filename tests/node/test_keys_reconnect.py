"""Channels that close and reopen during a change of keys."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.services.signing_setup import ListenForKey, SigningSetupClient, UseNewKey
from mavstack.services.signing_setup.key_change import TRIAL_DURATION
from mavstack.sim.virtual import run_virtually
from tests.node.signed_pair import CHANGES, NEW, THIRD, SignedPair, assert_both_use, refusals

pytestmark = pytest.mark.usefixtures("clock")


class InterruptedPair(SignedPair):
    """A pair whose link is interrupted during a change of keys.

    `stage` is the event, at the vehicle or at the ground station, after which the ground station receives
    nothing; until the vehicle has settled on the key, the vehicle receives nothing either.
    """

    def __init__(self, key, stage) -> None:
        super().__init__(key)
        self.stage = stage
        self.is_broken = False
        node = self.ground if stage is UseNewKey else self.vehicle
        on_event = node._on_event

        def on_event_or_interrupt(event, service) -> None:
            if isinstance(event, stage):
                self.interrupt()
            on_event(event, service)

        node._on_event = on_event_or_interrupt

    def interrupt(self) -> None:
        if not self.is_broken:
            self.is_broken = True
            (to_vehicle,), (to_ground,) = self.ground_link.channels, self.vehicle_link.channels
            to_ground.other = None
            if self.stage is not UseNewKey:
                to_vehicle.other = None

    async def reconnect(self, *, both: bool) -> None:  # type: ignore[override]
        (to_vehicle,), (to_ground,) = self.ground_link.channels, self.vehicle_link.channels
        to_vehicle.other = to_ground.other = None
        to_vehicle.close("a test")
        if both:
            to_ground.close("a test")
            await asyncio.sleep(0.01)
            self.ground_link.connect(self.vehicle_link)
            await asyncio.sleep(0)
            self.trust()
        else:  # as with UDP: the ground station reopens, and the vehicle does not notice
            await asyncio.sleep(0.01)
            again = type(to_vehicle)(self.vehicle_link._name, self.ground_link.inbox, self.network.clock)
            again.other, to_ground.other = to_ground, again
            self.ground_link.inbox.add_channel(again)


@pytest.mark.parametrize(("old", "new"), CHANGES)
@pytest.mark.parametrize("stage", [ListenForKey, UseNewKey])
@pytest.mark.parametrize("both", [True, False])
@pytest.mark.parametrize("after", [0.0, 3.0, 20.0])
def test_both_ends_receive_after_a_reconnect_during_a_change(old, new, stage, both, after) -> None:
    async def work() -> None:
        async with InterruptedPair(old, stage) as pair:
            await asyncio.sleep(1.2)
            task = asyncio.ensure_future(pair.setup_signing(new))
            await asyncio.sleep(1.0)
            assert pair.is_broken
            assert pair.server.key == (new if stage is UseNewKey else old)
            await asyncio.sleep(after)
            await pair.reconnect(both=both)
            await asyncio.gather(task, return_exceptions=True)
            await asyncio.sleep(20)
            await assert_both_use(pair, pair.server.key)
            assert not pair.remote._clients.get(SigningSetupClient).changing
            assert [node._keys._changes for node in pair.nodes] == [{}, {}]
            if task.exception() is None:
                assert pair.server.key == new

    run_virtually(work())


def setup(key, timestamp: int = 1) -> common.SetupSigning:
    return common.SetupSigning(
        target_system=1, target_component=1, secret_key=key.secret_bytes(), initial_timestamp=timestamp
    )


def test_a_failed_change_ends_on_reopened_channels_too() -> None:
    """Nothing was received on the reopened channel, so only its name relates it to the change."""

    async def work() -> None:
        async with SignedPair() as pair:
            await asyncio.sleep(1.2)
            pair.send_key(setup(NEW))
            await asyncio.sleep(0.1)
            assert pair.server.on_trial
            await pair.reconnect()
            (channel,) = pair.vehicle._host.engine.channels
            assert channel.signing is not None
            (to_ground,), (to_vehicle,) = pair.vehicle_link.channels, pair.ground_link.channels
            to_vehicle.other = None  # the vehicle receives nothing
            pair.vehicle._host.engine.routes.remove_channel(channel)
            await asyncio.sleep(TRIAL_DURATION)
            assert not pair.server.on_trial
            to_vehicle.other = to_ground
            await assert_both_use(pair, None)

    run_virtually(work())


def test_another_key_on_a_reopened_channel_ends_the_first_change_alone() -> None:
    async def work() -> None:
        async with SignedPair() as pair:
            await asyncio.sleep(1.2)
            pair.send_key(setup(NEW, 1))
            await asyncio.sleep(0.1)
            await pair.reconnect()
            await asyncio.sleep(0.1)
            pair.send_key(setup(THIRD, 2))
            await asyncio.sleep(0.1)
            assert pair.server.on_trial
            pair.ground._host.engine.channels[0].signing = THIRD.signing()
            await asyncio.sleep(1.5)
            assert pair.server.key == THIRD
            await assert_both_use(pair, THIRD)

    run_virtually(work())


@pytest.mark.parametrize("stays_closed", [True, False])
def test_a_channel_that_is_closed_during_a_change_uses_the_new_key(stays_closed) -> None:
    """The peer uses its key on all channels: those of the change, and those that opened meanwhile."""

    async def work() -> None:
        async with InterruptedPair(None, UseNewKey) as pair:
            second = MemoryNetwork()
            links = [second.link("memory://second"), second.link("memory://second")]
            for node, link in zip(pair.nodes, links, strict=True):
                await link.open()
                node._host.driver.read(link)
            await asyncio.sleep(1.2)
            if not stays_closed:
                links[0].channels[0].close("a test")
                await asyncio.sleep(0.01)
                for address in pair.ground._host.engine.routes._routes:
                    assert len(pair.ground._host.engine.routes.heard_on(address)) == 1
            pair.interrupt = lambda: None
            task = asyncio.ensure_future(pair.setup_signing(NEW))
            await asyncio.sleep(0.02)
            if stays_closed:
                links[0].channels[0].close("a test")
                await asyncio.sleep(0.01)
            else:
                links[0].connect(links[1])
            await task
            await asyncio.sleep(1)
            if stays_closed:
                links[0].connect(links[1])
            await asyncio.sleep(0.01)
            for _ in range(2):
                assert len(pair.ground._host.engine.channels) == len(pair.vehicle._host.engine.channels) == 2
                before = [refusals(node) for node in pair.nodes]
                await assert_both_use(pair, NEW)
                assert [refusals(node) for node in pair.nodes] == before
                assert all(
                    channel.signing.streams for node in pair.nodes for channel in node._host.engine.channels
                )
                links[0].channels[0].close("a test")
                links[0].connect(links[1])
                await asyncio.sleep(0.01)
            for link in links:
                await link.close()

    run_virtually(work())


@pytest.mark.parametrize("reconnects", [False, True])
def test_the_signing_state_of_the_change_is_kept_after_it(reconnects) -> None:
    """A new signing state would accept replayed packets."""

    async def work() -> None:
        async with SignedPair() as pair:
            await asyncio.sleep(1.2)
            pair.send_key(setup(NEW))
            await asyncio.sleep(0.1)
            if reconnects:
                await pair.reconnect()
            on_trial = pair.vehicle._host.engine.channels[0].signing
            pair.ground._host.engine.channels[0].signing = NEW.signing()
            await asyncio.sleep(1.5)
            assert pair.server.key == NEW
            assert pair.vehicle._host.engine.channels[0].signing is on_trial

    run_virtually(work())
