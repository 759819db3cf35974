from __future__ import annotations

from random import Random

from mavstack.dialects import Dialect, common
from mavstack.links.joined_datagrams import MAX_JOINED, join_datagrams
from mavstack.wire import Encoder, Parser

A, B = ("127.0.0.1", 1), ("127.0.0.1", 2)


def test_datagrams_of_one_sender_that_follow_each_other_are_joined():
    datagrams = [(b"a", A, 1.0), (b"b", A, 1.0), (b"x", B, 1.0), (b"c", A, 1.0)]
    assert list(join_datagrams(datagrams)) == [(b"ab", A, 1.0, 2), (b"x", B, 1.0, 1), (b"c", A, 1.0, 1)]


def test_datagrams_of_different_times_stay_apart():
    assert [data for data, *_ in join_datagrams([(b"a", A, 1.0), (b"b", A, 2.0)])] == [b"a", b"b"]


def test_large_datagrams_are_not_joined():
    half = bytes(MAX_JOINED // 2)
    assert [count for *_, count in join_datagrams([(half, A, 1.0)] * 2)] == [2]
    assert [count for *_, count in join_datagrams([(half, A, 1.0)] * 3)] == [1, 1, 1]


def test_a_parser_finds_the_same_packets_in_joined_datagrams():
    random, encoder = Random(7), Encoder(system=1, component=1)
    packets = [encoder.encode(common.Attitude(roll=number)) for number in range(200)]
    # Some datagrams end within their packet, some begin within it, as on a bridge from a lossy radio.
    cut = [data[random.randrange(9) :] if random.random() < 0.1 else data for data in packets]
    cut = [data[: -random.randrange(1, 9)] if random.random() < 0.1 else data for data in cut]
    dialect = Dialect.load("common")
    singly, joined = Parser(dialect), Parser(dialect)
    expected = [packet.raw for data in cut for packet in singly.feed(data)]
    found = [
        packet.raw
        for data, *_ in join_datagrams((data, A, 1.0) for data in cut)
        for packet in joined.feed(data)
    ]
    assert len(expected) > 150
    assert found == expected
    assert joined.statistics == singly.statistics
