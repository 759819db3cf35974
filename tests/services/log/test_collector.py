from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.services.log.collector import MAX_SIZE_ERROR, Collector
from mavstack.services.log.entry import CHUNK

if TYPE_CHECKING:
    from random import Random

FULL = bytes(range(90))


def chunk_of(content: bytes, number: int) -> bytes:
    return content[number * CHUNK : (number + 1) * CHUNK]


@given(st.integers(0, 2000), st.randoms(use_true_random=False))
def test_chunks_in_any_order_and_twice_make_the_log(size: int, random: Random) -> None:
    content = random.randbytes(size)
    collector = Collector(size)
    numbers = list(range(size // CHUNK + 1))
    random.shuffle(numbers)
    for number in numbers:
        assert not collector.complete
        assert collector.add(number, chunk_of(content, number), requested=True)
        assert not collector.add(number, chunk_of(content, number), requested=True)
    assert collector.complete
    assert not collector.contradicted
    assert collector.data() == content


@pytest.mark.parametrize("size", [90, 900])
def test_a_log_of_whole_chunks_ends_only_with_a_reported_end(size: int) -> None:
    collector = Collector(size)
    for number in range(size // CHUNK):
        collector.add(number, FULL, requested=True)
    assert collector.lacks_only_the_end
    assert not collector.complete
    assert collector.missing_range(0, 100, 0) == (size // CHUNK, size // CHUNK + 1)
    collector.add(size // CHUNK, b"", requested=True)
    assert collector.complete


def test_a_log_may_be_longer_than_it_was_listed() -> None:
    collector = Collector(100)
    collector.add(0, FULL, requested=True)
    collector.add(1, FULL, requested=True)
    assert not collector.complete
    collector.add(2, b"end", requested=True)
    assert collector.data() == FULL + FULL + b"end"


def test_an_early_end_of_a_log_must_be_reported_several_times() -> None:
    collector = Collector(1000)
    collector.add(0, FULL, requested=True)
    for times in range(3):
        assert not collector.complete, times
        collector.add(1, b"end", requested=True)
    assert collector.complete
    assert collector.data() == FULL + b"end"


def test_the_tail_of_what_another_client_else_requested_is_no_end() -> None:
    collector = Collector(1000)
    for _ in range(9):
        collector.add(3, b"0123456789", requested=False)
    assert not collector.end_known
    collector.add(3, b"0123456789" * 9, requested=True)
    assert not collector.contradicted


def test_a_log_much_shorter_than_listed_is_not_believed() -> None:
    collector = Collector(MAX_SIZE_ERROR + 100)
    for _ in range(3):
        collector.add(0, b"", requested=True)
    assert collector.contradicted


def test_an_end_before_what_is_there_is_not_believed() -> None:
    collector = Collector(1000)
    collector.add(5, FULL, requested=True)
    for _ in range(3):
        collector.add(2, b"end", requested=True)
    assert collector.contradicted


@pytest.mark.parametrize("other", [FULL[::-1], b"short"])
def test_data_received_twice_must_be_equal(other: bytes) -> None:
    collector = Collector(1000)
    collector.add(3, FULL, requested=True)
    collector.add(3, other, requested=True)
    assert collector.contradicted


def test_ranges() -> None:
    collector = Collector(20 * CHUNK + 5)
    assert collector.missing_range(0, 100, 0) == (0, 21)
    assert collector.missing_range(0, 8, 0) == (0, 8)
    for number in (2, 3, 4, 5, 8, 20):
        collector.add(number, FULL if number < 20 else b"01234", requested=True)
    assert collector.missing_range(0, 100, 0) == (0, 2)
    assert collector.missing_range(0, 100, 1) == (0, 2)
    assert collector.missing_range(0, 100, 4) == (0, 20)
    assert collector.missing_range(0, 7, 4) == (0, 7)
    assert collector.missing_range(2, 100, 0) == (6, 8)
    assert collector.missing_range(2, 100, 1) == (6, 20)
    assert collector.missing_range(20, 100, 0) == (0, 2), "round again"


@given(st.sets(st.integers(0, 40)), st.integers(0, 60), st.integers(1, 50), st.integers(0, 50))
def test_a_range_is_never_empty_and_starts_where_something_is_missing(
    there: set[int], cursor: int, maximum: int, merge: int
) -> None:
    collector = Collector(50 * CHUNK + 1)
    for number in there:
        collector.add(number, FULL, requested=True)
    start, end = collector.missing_range(cursor, maximum, merge)
    assert 0 <= start < end <= 51
    assert end - start <= maximum
    assert not {start, end - 1} & there or maximum < 51
    assert start not in there
