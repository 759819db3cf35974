"""Properties of the parser for random streams and random chunks."""

from __future__ import annotations

import array
import itertools
import mmap
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mavstack
from mavstack.dialects import Dialect, common, minimal
from mavstack.wire import Packet

from . import raw_packets
from .values import CASES, random_message

MESSAGES = tuple(Dialect.load("common"))
SOURCES = ((1, 1), (1, 100), (255, 190))

messages = st.builds(random_message, st.sampled_from(MESSAGES), st.sampled_from(CASES), st.integers(0, 2**32))


@st.composite
def packets(draw):
    """Draw one complete packet of any kind, with its properties."""
    kind = draw(st.sampled_from(("v2", "v2", "v1", "signed", "unknown")))
    system, component = draw(st.sampled_from(SOURCES))
    sequence = draw(st.integers(0, 255))
    if kind == "unknown":
        # A packet of an unknown id is certainly accepted only if its payload contains no magic.
        payload = bytes(draw(st.lists(st.integers(0, 200), max_size=30)))
        return raw_packets.version_2(
            0x50000 + sequence, payload, 7, system=system, component=component, sequence=sequence
        )
    message = draw(messages)
    version = 1 if kind == "v1" and message.definition.id < 256 else 2
    signing = mavstack.Signing(bytes(32)) if kind == "signed" else None
    return mavstack.encode(
        message, system=system, component=component, sequence=sequence, version=version, signing=signing
    )


no_magic = st.lists(st.integers(0, 0xFC), max_size=20).map(bytes)
garbage = st.lists(st.one_of(st.sampled_from((0xFD, 0xFE, 0, 1, 9)), st.integers(0, 255)), max_size=60).map(
    bytes
)
streams = st.lists(st.one_of(packets(), garbage), max_size=8).map(b"".join)
buffers = st.sampled_from((bytes, bytearray, memoryview, lambda data: memoryview(bytearray(data))))


def run(chunks, **options):
    parser = mavstack.Parser(common, **options)
    found = [packet for chunk in chunks for packet in parser.feed(chunk)] + parser.flush()
    assert parser.pending == 0
    return found, parser


def cut(data, positions):
    edges = sorted({0, len(data), *(position % (len(data) + 1) for position in positions)})
    return [data[start:end] for start, end in itertools.pairwise(edges)]


@given(streams, st.lists(st.integers(0, 5000), max_size=10), buffers, st.booleans())
def test_chunking_does_not_change_the_result(stream, positions, buffer, timestamped):
    whole, parser = run([stream], timestamped=timestamped)
    for chunks in (cut(stream, positions), [stream[i : i + 1] for i in range(len(stream))]):
        again, other = run(map(buffer, chunks), timestamped=timestamped)
        assert [(packet.raw, packet.timestamp) for packet in again] == [
            (packet.raw, packet.timestamp) for packet in whole
        ]
        assert other.statistics == parser.statistics
        assert other.sources == parser.sources


@given(streams)
def test_every_byte_is_counted_once(stream):
    found, parser = run([stream])
    statistics = parser.statistics
    assert statistics.packets == len(found) == statistics.version_1 + statistics.version_2
    assert statistics.packet_bytes == sum(map(len, found))
    assert statistics.packet_bytes + statistics.bad_bytes == len(stream)
    assert statistics.unknown == sum(packet.name is None for packet in found)
    assert statistics.signed == sum(packet.signed for packet in found)
    position = 0
    for packet in found:
        position = stream.index(packet.raw, position) + len(packet)
        assert (packet.message is None) == (packet.name is None)
        repr((packet, packet.message))


@given(st.binary(max_size=3000), st.booleans())
def test_random_bytes_never_raise(data, timestamped):
    run([data], timestamped=timestamped)


@given(st.lists(st.tuples(no_magic, packets()), max_size=6), no_magic)
def test_garbage_between_packets_hides_no_packet(pieces, tail):
    found, parser = run([b"".join(junk + packet for junk, packet in pieces) + tail])
    assert [packet.raw for packet in found] == [packet for _, packet in pieces]
    assert parser.statistics.bad_bytes == sum(len(junk) for junk, _ in pieces) + len(tail)
    expected = {}
    for _, raw in pieces:
        source = tuple(raw[5:7]) if raw[0] == 0xFD else tuple(raw[3:5])
        count, size = expected.get(source, (0, 0))
        expected[source] = (count + 1, size + len(raw))
    assert {source: (item.received, item.bytes) for source, item in parser.sources.items()} == expected


# A damaged packet passes its CRC once in 65,536 times; derandomized, the result is the same in each run.
@settings(derandomize=True)
@given(st.lists(messages, min_size=3, max_size=6), st.integers(0, 10_000), st.integers(1, 255))
def test_one_damaged_byte_loses_no_other_packet(contents, damaged, change):
    encoder = mavstack.Encoder(1, 1)
    sent = [encoder.encode(message) for message in contents]
    stream = bytearray(b"".join(sent))
    damaged %= len(stream)
    stream[damaged] ^= change
    found = {packet.raw for packet in run([stream])[0]}
    position = 0
    for raw in sent:
        if not position <= damaged < position + len(raw):
            assert raw in found
        position += len(raw)


@given(packets(), packets(), st.integers(0, 300))
def test_a_stream_may_begin_and_end_inside_a_packet(first, second, cut_at):
    whole = first + second * 3
    run([whole[: len(whole) - cut_at % len(second)]])
    found, _ = run([whole[cut_at % len(first) :]])
    assert found[-1].raw == second


@given(messages, st.sampled_from((1, 2)), st.integers(0, 255))
def test_encoding_and_parsing_preserves_the_message(message, version, sequence):
    if version == 1 and message.definition.id > 255:
        version = 2
    raw = mavstack.encode(message, system=3, component=4, sequence=sequence, version=version)
    (packet,) = run([raw])[0]
    assert (packet.system, packet.component, packet.sequence, packet.version) == (3, 4, sequence, version)
    assert (packet.name, packet.message_id) == (message.definition.name, message.definition.id)
    assert type(packet.message) is type(message)
    sent = type(message).from_payload(message.to_payload(version))
    assert packet.message == sent
    assert version == 1 or sent == message
    assert packet.payload == message.to_payload(version)
    again = Packet(raw, common, timestamp=5)
    assert (again, again.timestamp, hash(again)) == (packet, 5, hash(packet))
    assert pickle.loads(pickle.dumps(packet)).message == packet.message


@given(
    st.lists(
        st.tuples(no_magic.filter(lambda junk: len(junk) < 8), st.integers(0, 2**53), packets()), max_size=5
    )
)
def test_the_eight_bytes_before_a_packet_are_its_timestamp(pieces):
    # Times before the year 2000 are kept: they are microseconds since boot.
    stream = b"".join(junk + stamp.to_bytes(8, "big") + raw for junk, stamp, raw in pieces)
    if any(byte in (0xFD, 0xFE) for _, stamp, _ in pieces for byte in stamp.to_bytes(8, "big")):
        return
    found, _ = run([stream], timestamped=True)
    assert [packet.raw for packet in found] == [raw for _, _, raw in pieces]
    for packet, (junk, stamp, _) in zip(found, pieces, strict=True):
        swapped = int.from_bytes(stamp.to_bytes(8, "big"), "little")
        # After junk only a plausible time is accepted.
        assert packet.timestamp in (stamp, swapped) or (packet.timestamp is None and junk)


@pytest.mark.parametrize(
    "view",
    [
        bytes,
        bytearray,
        memoryview,
        lambda data: array.array("B", data),
        lambda data: np.frombuffer(data, np.uint8),
        lambda data: memoryview(bytes(byte for value in data for byte in (value, 0)))[::2],
        lambda data: memoryview(data[::-1])[::-1],
        lambda data: memoryview(data).cast("B", (len(data), 1)),
    ],
)
def test_any_byte_buffer_is_accepted(view):
    raw = mavstack.encode(common.Attitude(roll=0.5), system=1, component=1)
    assert [packet.raw for packet in mavstack.Parser(common).feed(view(raw))] == [raw]
    assert Packet(view(raw), common).raw == raw
    assert common.Attitude.from_payload(view(raw[10:-2])) == common.Attitude(roll=0.5)
    assert mavstack.wire.crc16(view(raw)) == raw_packets.crc(raw)


def test_a_memory_map_is_accepted(tmp_path):
    path = tmp_path / "raw"
    raw = mavstack.encode(common.Heartbeat(), system=1, component=1)
    path.write_bytes(raw * 3)
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        assert len(mavstack.Parser(common).feed(data)) == 3


@pytest.mark.parametrize("wrong", ["text", None, 5, [1, 2], array.array("d", [1.0]), np.zeros(3, "i8")])
def test_a_wrong_argument_raises_and_keeps_the_parser_state(wrong):
    parser = mavstack.Parser(common)
    raw = mavstack.encode(common.Heartbeat(), system=1, component=1)
    parser.feed(raw[:5])
    with pytest.raises((TypeError, BufferError)):
        parser.feed(wrong)
    assert len(parser.feed(raw[5:])) == 1


def test_packets_do_not_share_the_buffer_of_the_caller():
    raw = mavstack.encode(common.Attitude(roll=0.5), system=1, component=1)
    buffer = bytearray(raw)
    (packet,) = mavstack.Parser(common).feed(buffer)
    buffer[:] = bytes(len(buffer))
    assert (packet.raw, packet.message.roll) == (raw, 0.5)


def test_a_packet_is_created_from_exactly_one_packet():
    raw = mavstack.encode(common.Heartbeat(), system=1, component=1)
    for wrong in (b"", raw[:-1], raw + b"x", raw + raw, b"x" + raw, raw[:-1] + b"\0"):
        with pytest.raises(ValueError, match="exactly one valid"):
            Packet(wrong, common)


def test_each_parser_has_its_own_dialect():
    raw = mavstack.encode(common.Attitude(roll=0.5), system=1, component=1)
    small, large = mavstack.Parser(minimal), mavstack.Parser(common)
    assert small.feed(raw)[0].message is None
    assert large.feed(raw)[0].message == common.Attitude(roll=0.5)
    assert (small.statistics.unknown, large.statistics.unknown) == (1, 0)
    with pytest.raises(AttributeError):
        mavstack.Parser("common")


def test_flush_ends_a_stream_and_resets_the_parser():
    parser = mavstack.Parser(common)
    raw = mavstack.encode(common.Heartbeat(), system=1, component=1)
    assert parser.feed(b"\xfd\xff\0\0" + raw) == []
    assert [packet.raw for packet in parser.flush()] == [raw]
    assert [packet.raw for packet in parser.feed(raw)] == [raw]
    assert (parser.flush(), parser.pending, parser.statistics.bad_bytes) == ([], 0, 4)
