from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager

import pytest

import mavstack
from mavstack.dialects import common
from mavstack.links import BytesReceived, Impairment, memory_pair, open_link
from mavstack.links.radio import BANDWIDTH, BUFFER, Air, Radio, RadioFlow, RadioLink, sik_radio
from mavstack.sim.virtual import run_virtually

from .conformance import Conformance
from .peers import LinkPeer

HEARTBEAT = mavstack.encode(common.Heartbeat(), system=1, component=1)
MODEL = Impairment(bandwidth=1000.0, queue=400, latency=0.1)


class TestRadio(Conformance):
    """A link over radios conforms."""

    datagrams = True

    @asynccontextmanager
    async def pair(self, query=""):
        inner, other = memory_pair()
        link = sik_radio(inner, Impairment(bandwidth=1e9, latency=1e-6, queue=1 << 20))

        async def peer():
            return LinkPeer(await other.open())

        yield link, peer
        await other.close()

    async def test_unread_input_is_bounded(self):
        pytest.skip("bounded by the wrapped link")


def pair_of_flows() -> tuple[RadioFlow, RadioFlow]:
    air = Air(MODEL.bandwidth)
    return RadioFlow(MODEL, "out", air), RadioFlow(MODEL, "in", air)


def test_both_directions_share_the_air():
    there, back = pair_of_flows()
    assert there.send(bytes(200), 0.0)
    assert back.send(bytes(100), 0.0)
    assert there.next_timeout() == pytest.approx(0.2 + 0.1)
    assert back.next_timeout() == pytest.approx(0.3 + 0.1)


def test_a_full_buffer_drops_and_counts():
    flow, _ = pair_of_flows()
    assert [flow.send(bytes(200), 0.0) for _ in range(3)] == [True, True, False]
    assert flow.stats.overflowed == 1
    assert flow.send(bytes(200), 0.21)


def test_a_heartbeat_is_answered_with_the_state_of_the_radio():
    there, back = pair_of_flows()
    there.send(bytes(100), 0.0)
    back.stats.lost = 3
    (report,) = Radio(there, back).reports(bytes(20) + HEARTBEAT, 0.0)
    (packet,) = mavstack.Parser(common).feed(report)
    assert (packet.system, packet.component, packet.version) == (ord("3"), ord("D"), 1)
    status = packet.message
    assert isinstance(status, common.RadioStatus)
    assert (status.txbuf, status.rxerrors, status.fixed) == (75, 3, 0)
    assert status.rssi > status.noise > 0
    assert status.remrssi > status.remnoise > 0


def test_other_messages_are_not_answered():
    attitude = mavstack.encode(common.Attitude(), system=1, component=1)
    assert Radio(*pair_of_flows()).reports(attitude, 0.0) == []


def test_each_side_receives_the_reports_of_its_own_radio_only():
    async def work():
        inner, other = memory_pair()
        received = {"near": b"", "far": b""}

        async def read(name, link):
            async for event in link:
                if isinstance(event, BytesReceived):
                    received[name] += event.data

        async with sik_radio(inner) as near, other as far:
            await asyncio.sleep(0.1)
            tasks = [asyncio.create_task(read("near", near)), asyncio.create_task(read("far", far))]
            near.channels[0].write(HEARTBEAT)
            await asyncio.sleep(1)
            assert b"3D" in received["near"]
            assert received["far"] == HEARTBEAT
            received["near"] = b""
            far.channels[0].write(HEARTBEAT)
            await asyncio.sleep(1)
            assert received["near"] == HEARTBEAT
            assert b"3D" in received["far"]
            for task in tasks:
                task.cancel()

    run_virtually(work())


def test_the_option_of_a_url():
    link = open_link("udpout://127.0.0.1:9?radio=sik&loss=0.1")
    assert isinstance(link, RadioLink)
    outgoing, _ = link._models
    assert (outgoing.bandwidth, outgoing.queue, outgoing.loss) == (BANDWIDTH, BUFFER, 0.1)
    assert not isinstance(open_link("udpout://127.0.0.1:9?radio=none"), RadioLink)
    with pytest.raises(mavstack.LinkURLError, match="radio"):
        open_link("udpout://127.0.0.1:9?radio=ham")
