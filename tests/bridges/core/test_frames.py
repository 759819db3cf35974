"""Changes of axes and attitudes."""

from __future__ import annotations

from math import cos, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.bridges.core.frames import (
    conjugate,
    flip_body,
    frd_flu,
    from_ros_attitude,
    ned_enu,
    ned_to_enu_yaw,
    ros_attitude_of,
    rotate,
    to_ros_attitude,
)
from mavstack.rotation import from_euler

angles = st.floats(-3.0, 3.0)
numbers = st.floats(-1e3, 1e3)


def test_axes() -> None:
    assert ned_enu(1.0, 2.0, 3.0) == (2.0, 1.0, -3.0)
    assert frd_flu(1.0, 2.0, 3.0) == (1.0, -2.0, -3.0)


def test_a_level_vehicle_that_points_north_has_a_yaw_of_90_degrees() -> None:
    assert to_ros_attitude(1.0, 0.0, 0.0, 0.0) == pytest.approx((0.0, 0.0, sin(pi / 4), cos(pi / 4)))
    assert ned_to_enu_yaw(0.0) == pytest.approx(pi / 2)
    assert ned_to_enu_yaw(pi / 2) == pytest.approx(0.0)


@given(angles, angles, angles, numbers, numbers, numbers)
def test_attitudes_turn_vectors_as_those_of_mavlink(
    roll: float, pitch: float, yaw: float, x: float, y: float, z: float
) -> None:
    w, i, j, k = from_euler(roll, pitch, yaw)
    in_ned = rotate((i, j, k, w), (x, y, z))
    in_enu = rotate(to_ros_attitude(w, i, j, k), frd_flu(x, y, z))
    assert in_enu == pytest.approx(ned_enu(*in_ned), abs=1e-6)


@given(angles, angles, angles)
def test_angles_make_the_same_attitude(roll: float, pitch: float, yaw: float) -> None:
    assert ros_attitude_of(roll, pitch, yaw) == pytest.approx(to_ros_attitude(*from_euler(roll, pitch, yaw)))


@given(angles, angles, angles)
def test_attitudes_return(roll: float, pitch: float, yaw: float) -> None:
    q = from_euler(roll, pitch, yaw)
    assert from_ros_attitude(*to_ros_attitude(*q)) == pytest.approx(q)
    assert flip_body(*flip_body(*q)) == q


@given(angles, angles, angles, numbers, numbers, numbers)
def test_the_reverse_rotation(roll: float, pitch: float, yaw: float, x: float, y: float, z: float) -> None:
    q = to_ros_attitude(*from_euler(roll, pitch, yaw))
    assert rotate(conjugate(q), rotate(q, (x, y, z))) == pytest.approx((x, y, z), abs=1e-6)
