from __future__ import annotations

from itertools import accumulate

from hypothesis import given
from hypothesis import strategies as st

from mavstack.bridges.zenoh.frame_batch import samples_of


@given(packets=st.lists(st.binary(min_size=1, max_size=40)), limit=st.integers(10, 60))
def test_packets_stay_whole_and_in_order(packets: list[bytes], limit: int) -> None:
    samples = list(samples_of(packets, limit))
    assert b"".join(samples) == b"".join(packets)
    assert set(accumulate(map(len, samples))) <= set(accumulate(map(len, packets)))
    assert all(samples)
    assert all(len(sample) <= limit or sample in packets for sample in samples)


def test_a_packet_beyond_the_limit_is_a_separate_sample() -> None:
    assert list(samples_of([bytes(20), b"a", b"b", bytes(30)], 10)) == [bytes(20), b"ab", bytes(30)]


def test_packets_of_one_read_are_one_sample() -> None:
    assert [len(sample) for sample in samples_of([bytes(30)] * 47)] == [46 * 30, 30]
    assert list(samples_of([])) == []
