"""Trends of fields."""

from __future__ import annotations

import pytest

from mavstack.cli.common.errors import UsageError
from mavstack.cli.watch.observer import Observer
from mavstack.cli.watch.trend import MAX_AGE, MAX_SAMPLES, SAMPLE_INTERVAL, FieldPatterns, Trends, sparkline
from mavstack.dialects import Dialect, common
from mavstack.wire import Encoder

ALL = Dialect.load("all")


class Watched:
    """A vehicle whose attitude is observed and sampled."""

    def __init__(self, patterns: str, *labels: str) -> None:
        self.observers = {label: Observer(ALL) for label in labels or ("",)}
        for observer in self.observers.values():
            observer.open("link")
        self.trends = Trends(FieldPatterns(patterns, ALL))
        self.vehicle = Encoder(1, 1)

    def step(self, now: float, message=None, label: str = "") -> None:
        if message is not None:
            self.observers[label].receive("link", self.vehicle.encode(message), now)
        self.trends.sample(self.observers, now)


def test_the_samples_of_a_field_in_their_order():
    watched = Watched("ATTITUDE.roll")
    for step in range(4):
        watched.step(step * SAMPLE_INTERVAL, common.Attitude(roll=step, pitch=9.0))
    (row,) = watched.trends.rows()
    assert (row.name, row.source) == ("ATTITUDE.roll", "1/1")
    assert row.samples == (0.0, 1.0, 2.0, 3.0)
    assert row.text == "171.9°"


def test_samples_are_taken_at_the_interval_only():
    watched = Watched("ATTITUDE.roll")
    for step in range(10):
        watched.step(step * SAMPLE_INTERVAL / 5, common.Attitude(roll=step))
    assert watched.trends.rows()[0].samples == (0.0, 5.0)


@pytest.mark.parametrize(
    ("patterns", "fields"),
    [
        ("attitude.ROLL", ["roll"]),
        ("ATTITUDE.roll,ATTITUDE.p*", ["roll", "pitch", "pitchspeed"]),
        ("ATT*", ["roll", "pitch", "yaw", "rollspeed", "pitchspeed", "yawspeed"]),
    ],
)
def test_patterns(patterns, fields):
    watched = Watched(patterns)
    watched.step(0.0, common.Attitude())
    assert [row.name for row in watched.trends.rows()] == [f"ATTITUDE.{field}" for field in fields]


@pytest.mark.parametrize(
    "pattern", ["NONE.roll", "ATTITUDE.none", "HEARTBEAT.type", "SETUP_SIGNING.secret_key"]
)
def test_a_pattern_without_a_numeric_field_is_refused(pattern):
    with pytest.raises(UsageError, match=r"--trend .*no message has such a numeric field"):
        FieldPatterns(pattern, ALL)


def test_silence_and_unknown_values_leave_gaps():
    watched = Watched("ATTITUDE.roll")
    watched.step(0.0, common.Attitude(roll=1.0))
    watched.step(SAMPLE_INTERVAL, common.Attitude(roll=float("nan")))
    watched.step(SAMPLE_INTERVAL + MAX_AGE + 1)
    assert watched.trends.rows()[0].samples == (1.0, None, None)


def test_the_samples_are_bounded_and_sources_are_distinguished():
    watched = Watched("ATTITUDE.roll", "A", "B")
    for step in range(MAX_SAMPLES + 10):
        for label in "AB":
            watched.step(step * SAMPLE_INTERVAL, common.Attitude(roll=step), label)
    rows = watched.trends.rows()
    assert [row.source for row in rows] == ["A 1/1", "B 1/1"]
    assert len(rows[0].samples) == MAX_SAMPLES


def test_a_sparkline_shows_the_course():
    assert sparkline([0, 1, 2, 3, 4, 5, 6, 7], 8) == "▁▂▃▄▅▆▇█"
    assert sparkline([None, 5.0, None, 5.0], 4) == " ▁ ▁"
    assert sparkline([1, 2, 3], 2) == "▁█"
    assert sparkline([1.0], 4) == "   ▁"
    assert sparkline([], 3) == "   "
    assert sparkline([1.0], 0) == ""
    assert sparkline([-1e300, 1e300], 2) == "▁█"
