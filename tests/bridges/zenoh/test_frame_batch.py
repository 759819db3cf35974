from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mavstack.bridges.zenoh.frame_batch import FrameBatch


@given(packets=st.lists(st.binary(min_size=1, max_size=40)), limit=st.integers(10, 60))
def test_packets_stay_whole_and_in_order(packets: list[bytes], limit: int) -> None:
    batch, samples = FrameBatch(limit), []
    ends = set()
    for number, packet in enumerate(packets):
        if full := batch.add(packet):
            samples.append(full)
            ends.add(number)
    samples.append(batch.take())
    assert b"".join(samples) == b"".join(packets)
    assert all(len(sample) <= max(limit, *map(len, packets)) for sample in samples if packets)
    assert len(samples) == len(ends) + 1
    assert batch.take() == b""


def test_packets_of_one_read_are_one_sample() -> None:
    batch = FrameBatch()
    assert [batch.add(bytes(30)) for _ in range(46)] == [b""] * 46
    assert len(batch.add(bytes(30))) == 46 * 30
    assert len(batch.take()) == 30
