"""Speed, pauses and single steps."""

from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.simulators.pace import Pace


def test_a_speed_holds_steps_back():
    pace = Pace(2.0)
    assert pace.delay(0.0, 100.0) == 0.0
    assert pace.delay(1.0, 100.1) == pytest.approx(0.4)
    assert pace.delay(1.0, 100.5) == 0.0


def test_a_lag_is_not_caught_up():
    pace = Pace(1.0)
    pace.delay(0.0, 0.0)
    assert pace.delay(1.0, 9.0) == 0.0
    assert pace.delay(2.0, 9.0) == pytest.approx(1.0)


def test_no_speed_never_waits():
    pace = Pace(0.0)
    assert [pace.delay(time, 0.0) for time in (0.0, 5.0, 1e6)] == [0.0] * 3


def test_single_steps_and_a_resumption():
    changes = []
    pace = Pace(0.0, lambda: changes.append(1))
    pace.pause(steps=2)
    for _ in range(2):
        assert pace.delay(0.0, 0.0) == 0.0
        pace.count()
    assert pace.is_paused
    assert pace.delay(0.0, 0.0) is None
    pace.resume()
    assert not pace.is_paused
    assert len(changes) == 2


def test_wrong_numbers_are_refused():
    with pytest.raises(InvalidArgumentError, match="the speed must be 0 or more"):
        Pace(1.0).speed = -1.0
    with pytest.raises(InvalidArgumentError, match="the number of steps must be 0 or more"):
        Pace(1.0).pause(-1)
