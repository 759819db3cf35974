"""The schedule of polls: order, phases, the share of the line."""

from __future__ import annotations

from collections import Counter
from math import inf

import pytest

from mavstack.bridges.msp.poll_schedule import PollSchedule


def polled(schedule: PollSchedule[str], seconds: float, trip: float) -> Counter[str]:
    """Return how often each message is polled, if each answer takes `trip` seconds."""
    count: Counter[str] = Counter()
    now = 0.0
    while now < seconds:
        key = schedule.take(now)
        if key is None:
            now = max(schedule.next_due(), now + 1e-9)
            continue
        count[key] += 1
        schedule.finished(now, now + trip)
        now += trip
    return count


def test_each_message_at_its_interval() -> None:
    schedule = PollSchedule[str]()
    schedule.set_intervals({"attitude": 0.01, "gps": 0.5, "status": 0.2}, 0.0)
    count = polled(schedule, 10.0, 0.001)
    assert count["attitude"] == pytest.approx(1000, abs=5)
    assert (count["gps"], count["status"]) == (20, 50)


def test_a_line_that_is_too_slow_thins_out_all_alike() -> None:
    schedule = PollSchedule[str](share=1.0)
    schedule.set_intervals({"fast": 0.01, "slow": 0.1}, 0.0)
    count = polled(schedule, 100.0, 0.02)
    assert sum(count.values()) == pytest.approx(5000, abs=5)
    assert count["fast"] / count["slow"] == pytest.approx(9, abs=1.5)


def test_polls_use_a_share_of_the_time() -> None:
    schedule = PollSchedule[str](share=0.8)
    schedule.set_intervals({"attitude": 0.001}, 0.0)
    assert polled(schedule, 10.0, 0.01)["attitude"] == pytest.approx(800, abs=2)


def test_changes_of_intervals() -> None:
    schedule = PollSchedule[str]()
    assert (schedule.take(0.0), schedule.next_due()) == (None, inf)
    schedule.set_intervals({"one": 10.0}, 0.0)
    assert (schedule.take(0.0), schedule.take(5.0)) == ("one", None)
    schedule.set_intervals({"one": 1.0}, 5.0)
    assert (schedule.take(5.9), schedule.take(6.0)) == (None, "one")
    schedule.remove("one")
    assert schedule.keys == frozenset()
    schedule.set_intervals({"two": 1.0}, 7.0)
    assert schedule.take(7.0) == "two"


def test_missed_polls_are_skipped() -> None:
    schedule = PollSchedule[str]()
    schedule.set_intervals({"one": 1.0}, 0.0)
    assert schedule.take(0.0) == "one"
    assert schedule.take(50.0) == "one"
    assert schedule.take(50.5) is None
