"""The estimate from sensors."""

from __future__ import annotations

import math

import pytest

from mavstack.rotation import from_euler, rotate_back, to_euler
from mavstack.simulators.foreign.estimator import Estimator


def test_it_levels_itself_at_once_and_turns_with_the_gyroscope():
    estimator = Estimator()
    leaning = from_euler(0.3, 0.1, 0.0)
    estimator.predict(rotate_back(leaning, (0.0, 0.0, -9.80665)), (0.0, 0.0, 0.0), 0.0)
    assert to_euler(estimator.attitude)[:2] == pytest.approx((0.3, 0.1))
    for _ in range(100):
        estimator.predict((0.0, 0.0, -30.0), (0.0, 0.0, 0.5), 0.01)
    assert to_euler(estimator.attitude)[2] == pytest.approx(0.5, abs=0.05)


def test_a_wrong_tilt_is_levelled():
    estimator = Estimator()
    estimator.predict((0.0, 0.0, -9.80665), (0.0, 0.0, 0.0), 0.0)
    estimator.attitude = from_euler(0.4, -0.3, 0.0)
    for _ in range(3000):
        estimator.predict((0.0, 0.0, -9.80665), (0.0, 0.0, 0.0), 0.01)
    assert to_euler(estimator.attitude)[:2] == pytest.approx((0.0, 0.0), abs=0.01)


def test_the_field_gives_the_heading():
    estimator = Estimator()
    estimator.predict((0.0, 0.0, -9.80665), (0.0, 0.0, 0.0), 0.0)
    attitude = from_euler(0.0, 0.0, 1.2)
    declination = math.atan2(0.05, 0.2)
    estimator.take_field(rotate_back(attitude, (0.2, 0.05, 0.4)), declination)
    assert to_euler(estimator.attitude)[2] == pytest.approx(1.2)


def test_reports_draw_position_and_velocity():
    estimator = Estimator()
    estimator.take_place((10.0, 0.0, -5.0), (1.0, 0.0, 0.0))
    assert estimator.position == (10.0, 0.0, -5.0)
    estimator.predict((0.0, 0.0, -9.80665), (0.0, 0.0, 0.0), 0.5)
    assert estimator.position == pytest.approx((10.5, 0.0, -5.0), abs=0.01)
    estimator.take_place((11.5, 0.0, -5.0), (1.0, 0.0, 0.0))
    assert 10.5 < estimator.position[0] < 11.5
