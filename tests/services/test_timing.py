"""Timeouts that follow from measured round trips, as in RFC 6298."""

from __future__ import annotations

import pytest

from mavstack.services.timing import RoundTrip


def test_the_initial_timeout_doubles_with_each_attempt_up_to_the_maximum() -> None:
    round_trip = RoundTrip(0.5, maximum=3.0)
    assert [round_trip.timeout(attempt) for attempt in (1, 2, 3, 4, 99)] == [0.5, 1.0, 2.0, 3.0, 3.0]
    assert RoundTrip(8.0, maximum=5.0).timeout(3) == 8.0


def test_samples_are_smoothed_with_their_deviation() -> None:
    round_trip = RoundTrip()
    round_trip.add_sample(0.8)
    assert round_trip.timeout() == pytest.approx(0.8 + 4 * 0.4)
    round_trip.add_sample(1.6)
    deviation = 0.4 + (0.8 - 0.4) / 4
    assert round_trip.smoothed == pytest.approx(0.9)
    assert round_trip.timeout() == pytest.approx(0.9 + 4 * deviation)


def test_a_steady_round_trip_keeps_a_margin_and_the_minimum() -> None:
    steady, short = RoundTrip(minimum=0.05), RoundTrip(minimum=0.05)
    for _ in range(200):
        steady.add_sample(0.3)
        short.add_sample(0.001)
    assert steady.timeout() == pytest.approx(0.31)
    assert short.timeout() == 0.05
