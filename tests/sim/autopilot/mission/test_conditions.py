"""Condition items: time, distance and heading."""

from __future__ import annotations

from math import degrees, pi, remainder

import pytest

from mavstack.sim.vehicle_types import Firmware
from tests.sim.autopilot.mission.harness import (
    CMD,
    fly_items,
    item,
    waypoint,
)

ARDUPILOT, PX4 = Firmware.ARDUPILOT, Firmware.PX4


@pytest.mark.flight
def test_a_condition_of_time_holds_up_what_follows_but_not_the_flight() -> None:
    flight = fly_items(
        waypoint(5, 0, 10), item(CMD.CONDITION_DELAY, 4), item(CMD.DO_SET_SERVO, 9, 1900), waypoint(90, 0, 10)
    )
    flight.reach(5)
    flight.run(3)
    assert 9 not in flight.autopilot.payload.servos
    flight.run(2)
    assert flight.autopilot.payload.servos[9] == 1900
    assert 10 < flight.distance() < 60


@pytest.mark.flight
def test_px4_waits_for_a_condition() -> None:
    flight = fly_items(item(CMD.CONDITION_DELAY, 4), waypoint(60, 0, 10), firmware=PX4)
    flight.run(3.5)
    assert flight.mission.sequence == 1
    flight.reach(2, timeout=2)


@pytest.mark.flight
def test_a_condition_of_distance() -> None:
    flight = fly_items(
        waypoint(5, 0, 10),
        item(CMD.CONDITION_DISTANCE, 30),
        item(CMD.DO_SET_SERVO, 9, 1900),
        waypoint(90, 0, 10),
    )
    flight.run_until(lambda: 9 in flight.autopilot.payload.servos, timeout=60)
    assert flight.distance((90, 0)) == pytest.approx(30, abs=3)


@pytest.mark.flight
def test_a_heading_holds_until_the_next_waypoint() -> None:
    flight = fly_items(
        waypoint(5, 0, 10), item(CMD.CONDITION_YAW, 90), waypoint(80, 0, 10), waypoint(0, 0, 10)
    )
    flight.reach(4)
    flight.run(6)
    assert degrees(flight.body.truth.yaw) == pytest.approx(90, abs=8)
    flight.reach(5)
    flight.run(5)
    assert abs(degrees(flight.body.truth.yaw)) == pytest.approx(180, abs=15)


@pytest.mark.flight
def test_a_relative_heading() -> None:
    flight = fly_items(waypoint(5, 0, 10), item(CMD.CONDITION_YAW, 45, 0, -1, 1), waypoint(80, 0, 10))
    before = flight.body.truth.yaw
    flight.reach(4)
    flight.run(6)
    assert degrees(remainder(flight.body.truth.yaw - before, 2 * pi)) == pytest.approx(-45, abs=15)
