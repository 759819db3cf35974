"""A course that pauses slows down, waits, and continues where it was."""

from __future__ import annotations

import pytest

from mavstack.swarm.pace import RAMP, Pace

STEP = 0.1


def advance(pace, seconds):
    return sum(pace.advance(STEP) for _ in range(round(seconds / STEP)))


def test_a_course_flies_at_its_own_pace():
    assert advance(Pace(), 5.0) == pytest.approx(5.0)


def test_a_pause_stops_within_the_ramp_and_flies_on():
    pace = Pace()
    pace.paused = True
    assert advance(pace, RAMP / 2.0) == pytest.approx(0.375 * RAMP)
    assert (pace.rate, pace.slope) == pytest.approx((0.5, -1.0 / RAMP))
    advance(pace, RAMP)
    assert (pace.rate, pace.slope) == (0.0, 0.0)
    assert advance(pace, 60.0) == 0.0
    pace.paused = False
    assert advance(pace, RAMP) == pytest.approx(0.5 * RAMP)
    assert advance(pace, 5.0) == pytest.approx(5.0)


def test_a_step_without_time_changes_nothing():
    pace = Pace()
    pace.paused = True
    assert (pace.advance(0.0), pace.rate, pace.slope) == (0.0, 1.0, 0.0)
