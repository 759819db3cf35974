from __future__ import annotations

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.links.tlog import TlogScanner, looks_like_tlog

from .tlogs import entry, packet


def scan(data: bytes, size: int) -> list[tuple[float, bytes]]:
    scanner = TlogScanner()
    found = []
    for begin in range(0, len(data), size):
        found += scanner.feed(data[begin : begin + size])
    return found + scanner.finish()


packets = st.lists(
    st.builds(packet, st.binary(max_size=255), version=st.sampled_from([1, 2]), signed=st.booleans()),
    min_size=1, max_size=20,
)  # fmt: skip


@given(packets, st.integers(1, 700))
def test_packets_are_found_in_chunks_of_any_size(expected, size):
    data = b"".join(entry(1.7e9 + number, each) for number, each in enumerate(expected))
    assert [each for _, each in scan(data, size)] == expected
    assert [time for time, _ in scan(data, size)] == pytest.approx([1.7e9 + n for n in range(len(expected))])
    assert len(expected) < 2 or looks_like_tlog(data)


def test_junk_between_packets_is_kept():
    rng = random.Random(3)
    one, two = packet(b"one" * 9), packet(b"two" * 9, version=1)
    junk = rng.randbytes(100)
    data = junk + entry(1000.0, one) + b"\x01" * 50 + entry(1001.0, two) + entry(1002.0, one)[:-3]
    for size in (1, 7, 1000):
        found = scan(data, size)
        assert (1000.0, one) in found
        assert (1001.0, two) in found
        assert sum(len(each) for _, each in found) == len(data) - 2 * 8
    assert looks_like_tlog(data)


def test_a_raw_stream_is_not_a_tlog():
    stream = b"".join(packet(bytes([n] * 20)) for n in range(200))
    assert not looks_like_tlog(stream)
    zeros = packet(b"zero" + bytes(2) + b"time")
    assert not any(looks_like_tlog(zeros * count) for count in (1, 2, 3, 4, 50))
    assert not looks_like_tlog(b"")
    assert not looks_like_tlog(entry(1e9, packet(b"x"))[:9])


@given(st.binary(max_size=400), st.integers(1, 50))
def test_any_bytes_can_be_scanned(data, size):
    found = scan(data, size)
    assert sum(len(each) for _, each in found) <= len(data)
