"""Rotations."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.rotation import LEVEL, from_euler, rotate, rotate_back, to_euler, turned

angles = st.tuples(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
vectors = st.tuples(*[st.floats(-100, 100)] * 3)


def test_axes():
    east = from_euler(0.0, 0.0, math.radians(90))
    assert rotate(east, (1.0, 0.0, 0.0)) == pytest.approx((0.0, 1.0, 0.0), abs=1e-12)
    nose_up = from_euler(0.0, math.radians(90), 0.0)
    assert rotate(nose_up, (1.0, 0.0, 0.0)) == pytest.approx((0.0, 0.0, -1.0), abs=1e-12)
    right_wing_down = from_euler(math.radians(90), 0.0, 0.0)
    assert rotate(right_wing_down, (0.0, 1.0, 0.0)) == pytest.approx((0.0, 0.0, 1.0), abs=1e-12)


@pytest.mark.properties
@given(angles, vectors)
def test_back_is_the_inverse(euler, vector):
    attitude = from_euler(*euler)
    assert rotate_back(attitude, rotate(attitude, vector)) == pytest.approx(vector, abs=1e-9)


@pytest.mark.properties
@given(angles)
def test_euler_angles_come_back(euler):
    assert to_euler(from_euler(*euler)) == pytest.approx(euler, abs=1e-6)


@pytest.mark.properties
@given(angles, vectors, st.floats(1e-4, 0.1))
def test_turns_keep_the_length(euler, rates, dt):
    assert math.hypot(*turned(from_euler(*euler), rates, dt)) == pytest.approx(1.0)


def test_a_turn_is_the_angle_of_its_rate():
    attitude = LEVEL
    for _ in range(1000):
        attitude = turned(attitude, (0.0, 0.0, 0.5), 0.002)
    assert to_euler(attitude)[2] == pytest.approx(1.0)
