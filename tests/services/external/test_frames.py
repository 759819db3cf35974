from __future__ import annotations

from math import cos, isnan, pi, radians, sin, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.rotation import from_euler, rotate, to_euler
from mavstack.services.external.frames import (
    Frame,
    canonical,
    covariance_to_mavlink,
    orientation_to_mavlink,
    to_mavlink,
)

NUMBERS = st.floats(-100, 100, allow_subnormal=False)
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS)
ROTATIONS = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: sum(each * each for each in q) > 0.01)
WORLDS, BODIES = list(Frame), [Frame.FRD, Frame.FLU, Frame.RDF]


@pytest.mark.parametrize(
    ("frame", "expected"),
    [("NED", (1, 2, 3)), ("FRD", (1, 2, 3)), ("ENU", (2, 1, -3)), ("FLU", (1, -2, -3)), ("RDF", (3, 1, 2))],
)
def test_axes(frame, expected):
    assert to_mavlink(Frame(frame), (1, 2, 3)) == expected


def test_a_body_of_ros_that_looks_east_has_heading_90():
    roll, pitch, yaw = to_euler(orientation_to_mavlink(Frame.ENU, Frame.FLU, (1, 0, 0, 0)))
    assert (roll, pitch) == pytest.approx((0, 0))
    assert yaw == pytest.approx(pi / 2)
    half = sqrt(0.5)  # REP 103: a turn of 90 degrees from east is north
    assert to_euler(orientation_to_mavlink(Frame.ENU, Frame.FLU, (half, 0, 0, half)))[2] == pytest.approx(0)


def test_a_camera_that_has_not_moved_is_level():
    assert orientation_to_mavlink(Frame.RDF, Frame.RDF, (1, 0, 0, 0)) == pytest.approx((1, 0, 0, 0))


@given(st.sampled_from(WORLDS), st.sampled_from(BODIES), ROTATIONS, VECTORS)
def test_a_vector_of_the_body_is_the_same_in_both_axes(frame, body, rotation, vector):
    """Turning into the world and changing the axes may be done in either order."""
    turned_first = to_mavlink(frame, rotate(canonical(rotation), vector))
    orientation = orientation_to_mavlink(frame, body, canonical(rotation))
    changed_first = rotate(orientation, to_mavlink(body, vector))
    assert changed_first == pytest.approx(turned_first, abs=1e-9)


@given(*[st.floats(-1.4, 1.4)] * 3)
def test_angles_of_a_rotation(roll, pitch, yaw):
    assert to_euler(from_euler(roll, pitch, yaw)) == pytest.approx((roll, pitch, yaw), abs=1e-6)


def test_the_angles_at_the_pole_are_finite():
    assert to_euler(from_euler(0.0, radians(90), 0.0))[1] == pytest.approx(pi / 2)


def test_a_covariance_follows_its_axes():
    """The variances of east, north and up, and the covariance of east and up, whose sign changes."""
    full = [0.0] * 36
    for place, value in {0: 1.0, 7: 4.0, 14: 9.0, 2: 0.5, 12: 0.5, 21: 0.1, 28: 0.2, 35: 0.3}.items():
        full[place] = value
    triangle = covariance_to_mavlink(Frame.ENU, full)
    assert [triangle[place] for place in (0, 6, 11, 15, 18, 20)] == pytest.approx([4, 1, 9, 0.2, 0.1, 0.3])
    assert triangle[7] == pytest.approx(-0.5)  # north and down of the message are y and z of ROS
    again = [full[row * 6 + column] for row in range(6) for column in range(row, 6)]
    assert covariance_to_mavlink(Frame.ENU, again) == triangle


def test_a_covariance_of_zeros_is_not_known():
    assert all(isnan(each) for each in covariance_to_mavlink(Frame.ENU, [0.0] * 36))


def test_rotate_turns_the_right_way():
    turn = from_euler(0.0, 0.0, radians(30))
    assert rotate(turn, (1, 0, 0)) == pytest.approx((cos(radians(30)), sin(radians(30)), 0))
