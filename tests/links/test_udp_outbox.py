"""Datagrams that are written together leave by one system call, and none is lost without being counted."""

from __future__ import annotations

import asyncio
import errno
import os
import socket
from time import time

import pytest

from mavstack.dialects import common
from mavstack.links import open_link, udp_outbox
from mavstack.node import Node
from mavstack.security import SigningKey
from mavstack.services import Address
from mavstack.wire import Encoder, Parser
from tests.waiting import wait_until

from .peers import UdpPeer

pytestmark = pytest.mark.skipif(os.name != "posix", reason="datagrams are sent by a transport")


class SlowSender:
    """A socket that accepts a few datagrams at a time, and refuses some for ever."""

    def __init__(self, descriptor):
        self.room, self.sent = 0, []

    def send(self, datagrams):
        for count, (data, _) in enumerate(datagrams):
            if data == b"bad":
                return count, False
            if not self.room:
                return count, True
            self.room -= 1
            self.sent.append(data)
        return len(datagrams), False


@pytest.fixture
def slow(monkeypatch):
    monkeypatch.setattr(udp_outbox, "DatagramSender", SlowSender)


async def opened(link):
    """Return the only channel of a link that sends."""
    return (await anext(link)).channel


def write_together(link, channel, datagrams):
    link.hold()
    results = [channel.write(data) for data in datagrams]
    link.release()
    return results


def sender_of(link):
    return link._outbox._sender


async def test_what_a_node_sends_in_one_turn_leaves_in_order_by_one_system_call():
    peer = UdpPeer()
    async with Node(f"udpout://127.0.0.1:{peer.port}", heartbeat=False) as node:
        await wait_until(lambda: node._host.engine.channels)
        for number in range(50):
            node.send(common.NamedValueInt(name="n", value=number))
        await wait_until(lambda: node.links[0].counters.chunks_out == 50)
        assert sender_of(node.links[0]).calls == 1
        parser = Parser(common)
        packets = [packet for _ in range(50) for packet in parser.feed(await peer.receive(1))]
        assert [packet.message.value for packet in packets] == list(range(50))
        assert [packet.sequence for packet in packets] == list(range(50))
    await peer.close()


async def test_the_datagrams_for_several_peers_of_one_socket_leave_together():
    async with open_link("udpin://127.0.0.1:0") as link:
        peers = [UdpPeer(link.address) for _ in range(3)]
        for peer in peers:
            await peer.send(b"hello")
        await wait_until(lambda: len(link.channels) == 3)
        link.hold()
        for number, channel in enumerate(link.channels):
            channel.write(b"%d" % number)
        link.release()
        assert sender_of(link).calls == 1
        received = sorted([await peer.receive(1) for peer in peers])
        assert received == [b"0", b"1", b"2"]
        for peer in peers:
            await peer.close()


async def test_signed_packets_of_several_components_to_several_peers_leave_together():
    key, components = SigningKey.generate(), [Address(255, 190), Address(255, 191), Address(255, 192)]
    async with Node("udpin://127.0.0.1:0", heartbeat=False, signing=key) as node:
        address = node.links[0].address
        peers = {UdpPeer(address): Parser(common, signing=key.signing(link_id)) for link_id in (1, 2)}
        for number, peer in enumerate(peers, 1):
            signed = Encoder(number, 1, signing=key.signing(number))
            await peer.send(signed.encode(common.Heartbeat(), time()))
        await wait_until(lambda: len(node._host.engine.channels) == len(peers))
        sender = sender_of(node.links[0])
        before = 0 if sender is None else sender.calls
        engine, now = node._host.engine, node.now()
        for number in range(30):
            message = common.NamedValueInt(name="n", value=number)
            engine.send(message, now, source=components[number % len(components)])
        node._host.open_driver.step()
        assert sender_of(node.links[0]).calls == before + 1
        for peer, parser in peers.items():
            packets = []
            while len(packets) < 30:
                packets += parser.feed(await peer.receive(1), time())
            assert [each.message.value for each in packets] == list(range(30))
            assert all(each.signed for each in packets)
            for place, local in enumerate(components):
                own = packets[place :: len(components)]
                assert {(each.system, each.component) for each in own} == {local}
                assert [each.sequence for each in own] == list(range(10))
            stamps = [each.signature_timestamp for each in packets]
            assert stamps == sorted(set(stamps))
            await peer.close()


async def test_datagrams_that_the_system_does_not_accept_wait_in_order(slow):
    async with open_link("udpout://127.0.0.1:9") as link:
        channel = await opened(link)
        assert all(write_together(link, channel, [b"1", b"2"]))
        sender = sender_of(link)
        assert sender.sent == []
        sender.room = 1
        await wait_until(lambda: sender.sent)
        assert channel.write(b"3")
        sender.room = 10
        await wait_until(lambda: len(sender.sent) == 3)
        assert sender.sent == [b"1", b"2", b"3"]
        assert (channel.counters.chunks_out, channel.counters.dropped_out) == (3, 0)


async def test_waiting_datagrams_are_bounded_and_what_is_dropped_is_counted(slow):
    async with open_link("udpout://127.0.0.1:9?send_queue=10") as link:
        channel = await opened(link)
        assert write_together(link, channel, [b"1234", b"5678"]) == [True, True]
        assert [channel.write(b"90"), channel.write(b"x")] == [True, False]
        assert (channel.counters.bytes_out, channel.counters.dropped_out) == (10, 1)
        sender_of(link).room = 1
    assert (link.counters.bytes_out, link.counters.chunks_out, link.counters.dropped_out) == (4, 1, 3)


async def test_a_refused_datagram_is_counted_and_does_not_delay_the_next_ones(slow):
    async with open_link("udpout://127.0.0.1:9") as link:
        channel = await opened(link)
        write_together(link, channel, [b"bad", b"1"])
        sender = sender_of(link)
        sender.room = 5
        await wait_until(lambda: sender.sent)
        write_together(link, channel, [b"2", b"bad", b"3"])
        assert sender.sent == [b"1", b"2", b"3"]
        assert (channel.counters.chunks_out, channel.counters.dropped_out) == (3, 2)


async def test_a_datagram_that_is_written_alone_waits_too_if_it_must(slow):
    class FullSocket(socket.socket):
        def sendto(self, data, address):  # type: ignore[override]
            raise BlockingIOError

    async with open_link("udpout://127.0.0.1:9") as link:
        channel = await opened(link)
        link._socket = link._outbox._socket = FullSocket(fileno=link._socket.detach())
        assert channel.write(b"1")
        assert channel.write(b"2")
        await wait_until(lambda: sender_of(link))
        sender_of(link).room = 2
        await wait_until(lambda: sender_of(link).sent == [b"1", b"2"])


async def test_datagrams_leave_one_by_one_if_no_descriptor_is_left(monkeypatch):
    def refuse(descriptor):
        raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))

    monkeypatch.setattr(udp_outbox, "DatagramSender", refuse)
    peer = UdpPeer()
    async with open_link(f"udpout://127.0.0.1:{peer.port}") as link:
        channel = await opened(link)
        write_together(link, channel, [b"1", bytes(70_000), b"2"])
        assert [await peer.receive(1), await peer.receive(1)] == [b"1", b"2"]
        assert (channel.counters.chunks_out, channel.counters.dropped_out) == (2, 1)
    await peer.close()


async def test_many_refused_datagrams_cost_a_bounded_time_each(monkeypatch):
    passed = []

    class Refusing(SlowSender):
        def send(self, datagrams):
            passed.append(len(datagrams))
            return 0, False

    monkeypatch.setattr(udp_outbox, "DatagramSender", Refusing)
    async with open_link("udpout://127.0.0.1:9") as link:
        channel = await opened(link)
        write_together(link, channel, [b"x"] * 500)
        assert len(passed) == channel.counters.dropped_out == 500
        assert max(passed) <= udp_outbox.MAX_BATCH


async def test_a_link_whose_closing_is_cancelled_keeps_no_socket(slow):
    link = await open_link("udpout://127.0.0.1:9")
    channel = await opened(link)
    sock = link._socket
    write_together(link, channel, [b"1"])
    closing = asyncio.create_task(link.close())
    await wait_until(lambda: link._outbox is None)
    closing.cancel()
    with pytest.raises(asyncio.CancelledError):
        await closing
    assert sock.fileno() == -1
    assert link.counters.dropped_out == 1


async def test_datagrams_are_not_held_after_a_failure_in_their_turn():
    def fail(data):
        raise RuntimeError

    failures = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: failures.append(context["exception"]))
    peer = UdpPeer()
    async with Node(f"udpout://127.0.0.1:{peer.port}", heartbeat=False) as node:
        await wait_until(lambda: node._host.engine.channels)
        node._host.sent_listeners.append(fail)
        for number in (1, 2):
            node.send(common.NamedValueInt(name="n", value=number))
        await wait_until(lambda: failures)
        node._host.sent_listeners.clear()
        node.send(common.NamedValueInt(name="n", value=3))
        parser = Parser(common)
        async with asyncio.timeout(10):
            values = [packet.message.value for _ in (1, 3) for packet in parser.feed(await peer.receive(1))]
        assert values == [1, 3]
        assert isinstance(failures[0], RuntimeError)
    await peer.close()
