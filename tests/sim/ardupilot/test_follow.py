"""ArduPilot's Follow mode: entry, leader, offsets, limits, timeouts."""

from __future__ import annotations

from math import dist, hypot

import pytest

from mavstack.dialects import common
from tests.sim.harness import RESULT, VehicleHarness, airborne, grounded
from tests.sim.leaders import LEADER, MovingLeader

BEHIND = {"FOLL_OFS_TYPE": 1, "FOLL_OFS_X": -10.0}


def follower(vehicle_type: str = "copter", **parameters: float) -> VehicleHarness:
    harness = airborne(vehicle_type, "ardupilot").without_telemetry()
    harness.vehicle.parameters.set("FOLL_ENABLE", 1)
    harness.set_parameter("FOLL_ENABLE", 1)
    for name, value in parameters.items():
        harness.set_parameter(name, value)
    harness.vehicle.autopilot.enter(6 if vehicle_type != "copter" else 23, "test")
    assert harness.mode == "FOLLOW"
    return harness


def place(harness: VehicleHarness) -> tuple[float, float, float]:
    truth = harness.vehicle.body.truth
    return truth.north, truth.east, truth.down


def speed(harness: VehicleHarness) -> float:
    truth = harness.vehicle.body.truth
    return hypot(truth.velocity_north, truth.velocity_east)


def gap(harness: VehicleHarness, leader: MovingLeader) -> float:
    return hypot(*(its - mine for its, mine in zip(leader.place[:2], place(harness)[:2], strict=True)))


@pytest.mark.parametrize(
    ("vehicle_type", "number", "texts"),
    [
        ("copter", 23, ["Set FOLL_ENABLE = 1", "Mode change to FOLLOW failed: init failed"]),
        ("rover", 6, ["Flight mode change failed"]),
    ],
)
def test_the_mode_is_refused_without_its_parameter(vehicle_type, number, texts) -> None:
    harness = airborne(vehicle_type, "ardupilot")
    assert "FOLL_SYSID" not in harness.vehicle.parameters
    assert harness.command(common.MavCmd.DO_SET_MODE, 1, number) == RESULT.FAILED
    sent = [message.text for message in harness.received_of(common.Statustext)]
    assert [text for text in sent if "FOLL" in text or "mode" in text.lower()] == texts
    harness.set_parameter("FOLL_ENABLE", 1)
    assert "FOLL_SYSID" in harness.vehicle.parameters
    assert harness.command(common.MavCmd.DO_SET_MODE, 1, number) == RESULT.ACCEPTED


def test_a_rover_keeps_its_place_behind_the_leader() -> None:
    """A real ArduRover 4.1 kept 10.0 m behind a leader of 1.5 m/s, with an error of 0.34 m at most."""
    harness = follower("rover", WP_SPEED=3.0, **BEHIND)
    leader = MovingLeader(harness, (12.0, 0.0, 0.0), (1.5, 0.0, 0.0))
    harness.run(30, leader.report)
    errors: list[float] = []
    harness.run(10, lambda: (leader.report(), errors.append(abs(gap(harness, leader) - 10.0))))
    assert max(errors) < 0.5
    assert harness.vehicle.parameters["FOLL_SYSID"] == LEADER.system


def test_a_faster_leader_is_lost_without_a_word() -> None:
    harness = follower("rover", WP_SPEED=2.0, **BEHIND)
    leader = MovingLeader(harness, (12.0, 0.0, 0.0), (4.0, 0.0, 0.0))
    before = len(harness.texts)
    harness.run(30, leader.report)
    assert speed(harness) == pytest.approx(2.0, abs=0.3)
    assert gap(harness, leader) > 50.0
    harness.run(30, leader.report)  # FOLL_DIST_MAX
    assert speed(harness) < 0.1
    assert harness.texts[before:] == []


def test_a_copter_lags_by_its_braking_distance() -> None:
    harness = follower("copter", FOLL_OFS_Z=-5.0, **BEHIND)
    leader = MovingLeader(harness, (10.0, 0.0, -15.0), (3.0, 0.0, 0.0))
    harness.run(40, leader.report)
    assert speed(harness) == pytest.approx(3.0, abs=0.3)
    assert 12.0 < gap(harness, leader) < 16.0
    assert place(harness)[2] == pytest.approx(-20.0, abs=1.5)


def test_messages_end_after_three_seconds_and_the_leader_is_forgotten_after_ten() -> None:
    harness = follower("copter", **BEHIND)
    leader = MovingLeader(harness, (10.0, 0.0, -20.0), (3.0, 0.0, 0.0))
    harness.run(20, leader.report)
    harness.run(2.5)
    assert speed(harness) > 2.0
    harness.run(4.0)
    assert speed(harness) < 0.3
    assert harness.vehicle.parameters["FOLL_SYSID"] == LEADER.system
    harness.run(5.0)
    assert harness.vehicle.parameters["FOLL_SYSID"] == 0


def test_a_chosen_leader_is_the_only_one() -> None:
    harness = follower("copter", FOLL_SYSID=9, **BEHIND)
    leader = MovingLeader(harness, (10.0, 0.0, -20.0), (3.0, 0.0, 0.0))
    harness.run(8, leader.report)
    assert speed(harness) < 0.3
    assert harness.command(common.MavCmd.DO_FOLLOW, LEADER.system) == RESULT.ACCEPTED
    harness.run(8, leader.report)
    assert speed(harness) > 2.0
    assert harness.command(common.MavCmd.DO_FOLLOW, 300) == RESULT.DENIED


def test_without_an_offset_the_place_is_kept_until_the_mode_ends() -> None:
    harness = follower("copter", FOLL_OFS_TYPE=1)
    here = place(harness)
    leader = MovingLeader(harness, (here[0] + 6.0, here[1] + 8.0, here[2]), (0.0, 0.0, 0.0))
    harness.run(10, leader.report)
    assert "Relative follow offset loaded" in harness.texts
    assert dist(place(harness), here) < 1.5
    parameters = harness.vehicle.parameters
    assert parameters["FOLL_OFS_X"] == pytest.approx(-6.0, abs=0.5)
    harness.vehicle.autopilot.enter(5, "test")
    assert parameters["FOLL_OFS_X"] == 0.0


def test_a_target_message_replaces_positions() -> None:
    harness = follower("copter", **BEHIND)
    positions = MovingLeader(harness, (10.0, 0.0, -20.0), (0.0, 0.0, 0.0))
    targets = MovingLeader(harness, (10.0, 0.0, -20.0), (3.0, 0.0, 0.0), common.FollowTarget)
    harness.run(15, lambda: (targets.report(), positions.report()))
    assert speed(harness) == pytest.approx(3.0, abs=0.4)


def test_a_vehicle_on_the_ground_stays_there_and_no_place_is_no_leader() -> None:
    harness = grounded("copter", "ardupilot", FOLL_ENABLE=1).without_telemetry()
    harness.vehicle.autopilot.arm(force=True)
    harness.vehicle.autopilot.enter(23, "test")
    leader = MovingLeader(harness, (10.0, 0.0, -20.0), (3.0, 0.0, 0.0))
    harness.run(5, leader.report)
    assert harness.vehicle.autopilot.landed
    harness.send(common.GlobalPositionInt(vx=500), LEADER)
    assert harness.vehicle.parameters["FOLL_SYSID"] == LEADER.system
