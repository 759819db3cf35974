"""The signing timestamp of a node: stored, loaded, and never decreasing."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import SigningError
from mavstack.node import Node
from mavstack.node.keys import STORE_INTERVAL
from mavstack.security import TimestampStore
from mavstack.security.timestamps import LastRun
from mavstack.sim.virtual import run_virtually
from tests.node.signed_pair import NEW, OLD, PX4, SignedPair, assert_both_use, receive_packets

pytestmark = pytest.mark.usefixtures("clock")


class Store(TimestampStore):
    """A store in memory; `error` makes `store` fail."""

    def __init__(self, start: int = 0) -> None:
        super().__init__("nowhere")
        self.stored: list[int] = []
        self.start = start
        self.error: Exception | None = None

    def begin_run(self, timestamp=0) -> LastRun:
        return LastRun(self.stored[-1] if self.stored else self.start)

    def store(self, timestamp, streams=(), *, floor=0, running=False) -> None:
        if self.error is not None:
            raise self.error
        self.stored.append(timestamp)


def test_the_timestamp_is_stored_periodically_and_on_close() -> None:
    async def work() -> None:
        store = Store()
        async with SignedPair(OLD, timestamps=store) as pair:
            await asyncio.sleep(STORE_INTERVAL - 0.1)
            assert store.stored == []
            await asyncio.sleep(3 * STORE_INTERVAL)
            assert len(store.stored) == 3
            signing = pair.vehicle._host.engine.channels[0].signing
            assert store.stored == sorted(set(store.stored))
            assert store.stored[-1] >= signing.timestamp - STORE_INTERVAL * 1e5
            await asyncio.sleep(7)
        assert store.stored[4:] == [signing.timestamp]

    run_virtually(work())


@pytest.mark.parametrize("error", [SigningError("the card is full"), RuntimeError("a defect")])
def test_a_failing_store_is_reported_and_stops_nothing(error) -> None:
    async def work() -> None:
        reported: list[dict] = []
        asyncio.get_running_loop().set_exception_handler(lambda _, context: reported.append(context))
        store = Store()
        store.error = error
        async with SignedPair(OLD, timestamps=store) as pair:
            await asyncio.sleep(2 * STORE_INTERVAL + 1)
            assert [context["exception"] for context in reported] == [error] * 2
            await assert_both_use(pair, OLD)
            store.error = None
            await asyncio.sleep(STORE_INTERVAL)
            assert len(store.stored) == 1
            store.error = error
        assert len(reported) == 3
        assert pair.vehicle_link.closed

    run_virtually(work())


def test_the_timestamp_of_a_closed_channel_is_stored_too() -> None:
    async def work() -> None:
        store = Store()
        async with SignedPair(OLD, timestamps=store) as pair:
            await asyncio.sleep(5)
            signing = pair.vehicle._host.engine.channels[0].signing
            await pair.ground.close()
            await asyncio.sleep(0.1)
            assert pair.vehicle._host.engine.channels == []
        assert store.stored == [signing.timestamp]

    run_virtually(work())


def test_open_fails_with_a_damaged_store(tmp_path) -> None:
    (tmp_path / "clock").write_text("yesterday")

    async def work() -> None:
        pair = SignedPair(OLD, timestamps=TimestampStore(tmp_path / "clock"))
        with pytest.raises(SigningError, match="cannot read the signing timestamp"):
            await pair.vehicle.open()
        assert not pair.vehicle.is_open
        await pair.vehicle.close()

    run_virtually(work())


def test_timestamps_rise_over_a_restart_of_a_node_without_a_clock(tmp_path, clock) -> None:
    """The node learned the time from the ground station; after a restart it has it from its store."""
    store = TimestampStore(tmp_path / "clock")
    newest = []

    async def work() -> None:
        pair = SignedPair(OLD, timestamps=store)
        async with pair.ground:
            clock(1000.0)
            async with pair.vehicle:
                newest.extend(packet.signature_timestamp for packet in await receive_packets(pair.ground))
            assert newest[-1] <= store.load()
            link = pair.network.link()
            again = Node(link, system=1, component=1, autopilot=PX4, signing=OLD, timestamps=store)
            async with again:
                newest.extend(packet.signature_timestamp for packet in await receive_packets(pair.ground))

    run_virtually(work())
    assert len(newest) > 4
    assert newest == sorted(set(newest))


def test_timestamps_rise_over_a_reconnect_of_a_node_without_a_clock(clock) -> None:
    async def work() -> list[int]:
        clock(1000.0)
        async with SignedPair(OLD) as pair:
            for node in pair.nodes:
                node._host.engine.channels[0].signing = OLD.signing(timestamp=10**12)
            first = await receive_packets(pair.ground)
            await pair.reconnect()
            return [packet.signature_timestamp for packet in first + await receive_packets(pair.ground)]

    timestamps = run_virtually(work())
    assert timestamps == sorted(set(timestamps))


def test_a_key_can_be_installed_on_a_node_without_a_clock(clock) -> None:
    """The node signs with the timestamp of SETUP_SIGNING; its own would be refused as stale."""

    async def work() -> None:
        pair = SignedPair()
        await pair.ground.open()
        clock(1000.0)
        async with pair:
            await pair.setup_signing(NEW)
            await assert_both_use(pair, NEW)

    run_virtually(work())
