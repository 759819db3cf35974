"""The last packets of all streams."""

from __future__ import annotations

from mavstack.cli.watch.inspector.packet_store import PacketStore, StreamKey
from mavstack.dialects import common
from mavstack.wire import Packet, encode
from tests.cli.watch.inspector.watched import ALL, HEARTBEAT_ID, stream


def packet(message=None, system: int = 1) -> Packet:
    return Packet(encode(message or common.Attitude(), system=system, component=1), ALL)


def test_packets_are_kept_by_stream_in_their_order():
    store = PacketStore()
    store.add("", [packet(), packet(common.Heartbeat()), packet()], 1.0)
    store.add("", [packet()], 2.0)
    assert [entry.time for entry in store.stream(stream())] == [1.0, 1.0, 2.0]
    assert [entry.number for entry in store.newest(stream(), 2)] == [4, 3]
    assert [entry.stream.message_id for entry in store.newest(None, 10)] == [30, 30, 0, 30]


def test_the_oldest_packets_of_all_streams_are_dropped():
    store = PacketStore(3)
    store.add("", [packet(common.Heartbeat()), packet(), packet(), packet()], 1.0)
    assert (len(store), len(list(store))) == (3, 3)
    assert list(store.stream(stream(HEARTBEAT_ID))) == []
    store.add("", [packet()] * 5, 2.0)
    assert [entry.time for entry in store.stream(stream())] == [2.0] * 3


def test_packets_since_a_number():
    store = PacketStore()
    store.add("", [packet()] * 4, 1.0)
    assert [entry.number for entry in store.since(stream(), 2)] == [3, 4]
    assert store.since(stream(), 4) == store.since(stream(system=9), 0) == []


def test_a_copy_stays_as_it_is():
    store = PacketStore()
    store.add("", [packet()], 1.0)
    copy = store.copy()
    store.add("", [packet()], 2.0)
    assert (len(copy.stream(stream())), len(store.stream(stream()))) == (1, 2)


def test_the_source_of_a_stream():
    assert StreamKey("", 1, 154, 0).source == "1/154"
    assert StreamKey("B", 1, 154, 0).source == "B 1/154"
