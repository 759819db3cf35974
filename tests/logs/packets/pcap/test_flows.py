"""Flows: TCP data in order, without repetitions, and after gaps."""

from __future__ import annotations

import random

import pytest

import mavstack
from mavstack.dialects import common
from mavstack.logs.packets.pcap.datagrams import Segment
from mavstack.logs.packets.pcap.flows import Flow, FlowKey, Flows
from tests.logs.files import encoded
from tests.logs.packets.pcap.captures import CLIENT, SERVER

PACKETS = encoded([common.Attitude(time_boot_ms=number) for number in range(60)])
STREAM = b"".join(PACKETS)
SIZE = 37


def segments(first):
    """Return the stream in segments, the first of which opens the connection."""
    opening = Segment("tcp", CLIENT, SERVER, b"", first, True)
    pieces = range(0, len(STREAM), SIZE)
    return [opening] + [
        Segment("tcp", CLIENT, SERVER, STREAM[at : at + SIZE], first + at & 0xFFFF_FFFF) for at in pieces
    ]


def received(pieces, flow=None):
    flow = flow or Flow(mavstack.Parser(common.dialect))
    found = [item for time, piece in enumerate(pieces) for item in flow.receive(piece, time)]
    return [*found, *flow.finish()], flow


def numbers(found):
    return [packet.message.time_boot_ms for _, packet in found]


@pytest.mark.parametrize("first", [0, 1000, 2**32 - 700])
def test_segments_in_any_order_and_repeated(first):
    pieces = segments(first)
    shuffled = pieces[:1] + random.Random(1).sample(pieces[1:] + pieces[5:20], len(pieces) + 14)
    for order in (pieces, shuffled):
        found, flow = received(order)
        assert numbers(found) == list(range(60))
        assert (flow.lost_bytes, flow.known_packets, flow.payload_bytes) == (0, 60, len(STREAM))


def test_a_longer_repetition_adds_its_end():
    joined = Segment("tcp", CLIENT, SERVER, STREAM[10:200], 10)
    found, _ = received([*segments(0)[:3], joined])
    assert numbers(found) == list(range(200 // len(PACKETS[0])))


def test_a_missing_segment_costs_its_packets():
    pieces = segments(0)
    found, flow = received(pieces[:20] + pieces[21:])
    assert flow.lost_bytes == SIZE
    assert 57 <= len(found) < 60
    assert sorted(time for time, _ in found) == [time for time, _ in found], "times are those of the segments"


def test_a_capture_that_begins_inside_a_connection():
    found, flow = received(segments(5000)[10:])
    assert numbers(found)[-1] == 59
    assert flow.lost_bytes == 0


def test_a_second_connection_from_the_same_port():
    found, flow = received([*segments(0), *segments(123456)])
    assert numbers(found) == [*range(60), *range(60)]
    assert flow.lost_bytes == 0


def test_flows_are_kept_apart():
    flows = Flows(common.dialect)
    half = len(PACKETS[0]) // 2
    ends = [(CLIENT, SERVER), (SERVER, CLIENT)]
    found = []
    for part in (PACKETS[0][:half], PACKETS[0][half:]):
        for source, target in ends:
            found += flows.receive(Segment("udp", source, target, part), 7)
    assert [(str(key), time) for key, time, _ in found] == [
        ("udp 10.0.0.1:40000 → 10.0.0.2:14550", 7),
        ("udp 10.0.0.2:14550 → 10.0.0.1:40000", 7),
    ]
    assert list(flows.by_key) == [FlowKey("udp", *end) for end in ends]
