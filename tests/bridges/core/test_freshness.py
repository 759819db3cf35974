from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.bridges.core.freshness import MAX_SOURCES, RESET_TIME, Freshness


@given(offset=st.floats(-1e9, 1e9), delays=st.lists(st.floats(0.0, 20.0), min_size=1, max_size=30))
def test_the_clock_of_a_source_does_not_matter(offset: float, delays: list[float]) -> None:
    """The age is the delay beyond the shortest one, whatever the clock of the source shows."""
    freshness, shortest = Freshness(), delays[0]
    for number, delay in enumerate(delays):
        now = 100.0 + number * 0.1
        age = freshness.age("a", now - delay - offset, now - 0.0)
        shortest = min(shortest, delay)
        assert age == pytest.approx(delay - shortest, abs=1e-2 + abs(offset) * 1e-15)


def test_samples_that_a_cut_held_back_are_old() -> None:
    freshness = Freshness()
    assert [freshness.age("a", t / 10, t / 10 + 0.05) for t in range(20)] == pytest.approx(
        [0.0] * 20, abs=1e-2
    )
    held_back = [freshness.age("a", 2.0 + t / 10, 10.0 + t / 1000) for t in range(50)]
    assert held_back[0] == pytest.approx(7.95, abs=0.01)
    assert all(age > 2.9 for age in held_back)
    assert freshness.age("a", 10.1, 10.15) < 0.05


def test_a_network_that_is_slow_for_an_hour_does_not_become_the_measure() -> None:
    freshness = Freshness()
    freshness.age("a", 0.0, 0.05)
    ages = [freshness.age("a", float(t), t + 2.05) for t in range(1, 3600, 5)]
    assert min(ages) > 1.5


def test_a_clock_that_is_set_back_is_measured_anew() -> None:
    freshness = Freshness()
    freshness.age("a", 1000.0, 1000.05)
    late = [freshness.age("a", t / 10, 1001.0 + t / 10) for t in range(100)]
    assert late[0] > 900
    assert late[int(RESET_TIME * 10) + 2] == pytest.approx(0.0, abs=0.01)
    assert late[-1] == pytest.approx(0.0, abs=0.01)


def test_a_clock_that_is_set_forward_counts_at_once() -> None:
    freshness = Freshness()
    freshness.age("a", 0.0, 1000.0)
    assert freshness.age("a", 1000.9, 1001.0) == 0.0
    assert freshness.age("a", 1001.0, 1002.1) == pytest.approx(1.0, abs=0.01)


def test_sources_are_bounded() -> None:
    freshness = Freshness()
    for number in range(MAX_SOURCES * 2):
        freshness.age(str(number), 0.0, 1.0)
    assert len(freshness._sources) == MAX_SOURCES
