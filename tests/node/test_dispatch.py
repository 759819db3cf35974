"""Dispatch of packets to listeners, and the index of services."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.node.dispatch import MAX_CACHED, PacketDispatch
from mavstack.node.service_index import MAX_CACHED as MAX_SERVICES_CACHED
from mavstack.node.service_index import ServiceIndex
from mavstack.services import BROADCAST, Address, Service
from mavstack.wire import Packet, encode

HEARTBEAT, ATTITUDE = common.Heartbeat(), common.Attitude()


def packet(message, system: int = 1, component: int = 1) -> Packet:
    return Packet(encode(message, system=system, component=component), common)


def test_each_listener_gets_its_packets() -> None:
    dispatch, received = PacketDispatch(), []
    first = dispatch.add([common.Heartbeat], BROADCAST, lambda _: received.append("first"))
    dispatch.deliver(packet(HEARTBEAT))
    dispatch.add([], Address(1, 0), lambda _: received.append("all of 1"))
    dispatch.add([], Address(2, 7), lambda _: received.append("2/7"))
    dispatch.deliver(packet(HEARTBEAT))
    dispatch.deliver(packet(ATTITUDE, system=2))
    dispatch.deliver(packet(ATTITUDE, system=2, component=7))
    first.close()
    first.close()
    dispatch.deliver(packet(HEARTBEAT))
    assert received == [
        "first",
        "all of 1",
        "first",
        "2/7",
        "all of 1",
    ]  # listeners to all packets are first


def test_a_listener_may_close_during_the_dispatch() -> None:
    dispatch, received = PacketDispatch(), []

    def once(_: Packet) -> None:
        received.append("once")
        listening.close()

    listening = dispatch.add([], BROADCAST, once)
    dispatch.add([], BROADCAST, lambda _: received.append("always"))
    dispatch.deliver(packet(HEARTBEAT))
    dispatch.deliver(packet(HEARTBEAT))
    assert received == ["once", "always", "always"]


def test_the_lookup_caches_are_bounded() -> None:
    dispatch, index, received = PacketDispatch(), ServiceIndex(), []
    dispatch.add([], BROADCAST, received.append)
    for number in range(2 * MAX_CACHED):
        dispatch.deliver(packet(HEARTBEAT, 1 + number % 255, 1 + number // 255))
        index.find(number, 1)
    assert len(received) == 2 * MAX_CACHED
    assert len(dispatch._cache) <= MAX_CACHED
    assert len(index._cache) <= MAX_SERVICES_CACHED


def test_services_are_found_by_their_current_ids() -> None:
    index = ServiceIndex()
    server, client = Service(Address(255, 190)), Service(Address(255, 190))
    client.source_filter = Address(1, 1)
    server.handles, client.handles = frozenset({0}), frozenset({0, 30})
    for service in (server, client):
        index.update(service)
    assert index.find(0, 1) == (server, client)
    assert index.find(0, 2) == (server,)
    assert index.find(0, 0) == (server,)
    assert index.find(30, 1) == (client,)
    client.handles = frozenset({30})
    index.update(client)
    assert index.find(0, 1) == (server,)
    index.remove(client)
    assert index.find(30, 1) == ()
