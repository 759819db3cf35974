"""PX4's Follow Target mode: distance, angle, height, timeout."""

from __future__ import annotations

from math import dist, hypot

import pytest

from mavstack.dialects import common
from mavstack.sim.px4.modes import FOLLOW_TARGET
from tests.sim.harness import RESULT, VehicleHarness, airborne
from tests.sim.leaders import MovingLeader


def follower(**parameters: float) -> VehicleHarness:
    harness = airborne("copter", "px4").without_telemetry()
    for name, value in parameters.items():
        harness.set_parameter(name, value)
    assert harness.command(common.MavCmd.DO_SET_MODE, 1, 4, 8) == RESULT.ACCEPTED
    assert harness.vehicle.autopilot.mode.number == FOLLOW_TARGET
    return harness


def height(harness: VehicleHarness) -> float:
    return harness.vehicle.autopilot.home_position[2] - place(harness)[2]


def place(harness: VehicleHarness) -> tuple[float, float, float]:
    truth = harness.vehicle.body.truth
    return truth.north, truth.east, truth.down


def test_the_place_is_behind_the_course() -> None:
    harness = follower(FLW_TGT_DST=10.0, FLW_TGT_HT=20.0)
    leader = MovingLeader(harness, (10.0, 0.0, 0.0), (0.0, 3.0, 0.0), common.FollowTarget)
    harness.run(30, leader.report)
    north, east, _ = place(harness)
    assert north == pytest.approx(leader.place[0], abs=1.0)
    assert leader.place[1] - east == pytest.approx(10.0, abs=1.5)
    assert height(harness) == pytest.approx(20.0, abs=1.0)


def test_the_angle_is_clockwise_from_the_course() -> None:
    harness = follower(FLW_TGT_DST=10.0, FLW_TGT_HT=20.0, FLW_TGT_FA=90.0)
    leader = MovingLeader(harness, (10.0, 0.0, 0.0), (2.0, 0.0, 0.0), common.FollowTarget)
    harness.run(30, leader.report)
    north, east, _ = place(harness)
    assert east == pytest.approx(10.0, abs=1.5)
    assert north == pytest.approx(leader.place[0], abs=1.5)


def test_the_height_comes_first() -> None:
    harness = follower(FLW_TGT_HT=30.0)
    leader = MovingLeader(harness, (60.0, 0.0, 0.0), (0.0, 0.0, 0.0), common.FollowTarget)
    before = place(harness)
    harness.run(1.5, leader.report)
    assert dist(place(harness)[:2], before[:2]) < 0.5
    harness.run(25, leader.report)
    assert height(harness) == pytest.approx(30.0, abs=1.0)
    assert 60.0 - place(harness)[0] == pytest.approx(8.0, abs=1.5)


def test_other_positions_do_not_count_and_a_silent_target_stops_it() -> None:
    harness = follower(FLW_TGT_HT=20.0)
    deaf = MovingLeader(harness, (10.0, 0.0, 0.0), (3.0, 0.0, 0.0))
    harness.run(5, deaf.report)
    assert hypot(*place(harness)[:2]) < 1.0
    leader = MovingLeader(harness, (10.0, 0.0, 0.0), (3.0, 0.0, 0.0), common.FollowTarget)
    harness.run(15, leader.report)
    before = len(harness.texts)
    harness.run(10)
    truth = harness.vehicle.body.truth
    assert hypot(truth.velocity_north, truth.velocity_east) < 0.3
    assert harness.texts[before:] == []
    assert harness.vehicle.autopilot.mode.number == FOLLOW_TARGET
