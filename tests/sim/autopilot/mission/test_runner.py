"""External changes to a mission in flight: pauses, other items, new plans, mode changes."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.autopilot.harness import HOLD
from tests.sim.autopilot.mission.harness import CMD, RESULT, STATE, MissionHarness, item, takeoff, waypoint

ARDUPILOT, PX4 = Firmware.ARDUPILOT, Firmware.PX4


def flying(firmware: Firmware = ARDUPILOT, kind: VehicleType = VehicleType.COPTER) -> MissionHarness:
    """On the way to the first of three waypoints."""
    flight = MissionHarness(kind, firmware)
    flight.load(takeoff(10), waypoint(60, 0, 10), waypoint(60, 60, 10), waypoint(0, 60, 10))
    flight.start()
    flight.reach(flight.first + 1)
    flight.run(2)
    return flight


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_another_current_item(firmware: Firmware) -> None:
    flight = flying(firmware)
    flight.set_current(flight.first + 3)
    flight.run(0.2)
    flight.ended()
    assert flight.distance((0, 60)) < 4
    assert flight.reached == [flight.first, flight.first + 3]


@pytest.mark.flight
def test_back_to_the_beginning() -> None:
    flight = flying()
    flight.set_current(0)
    flight.run(0.5)
    assert flight.currents[-3:] == [0, 1, 2]
    flight.ended()
    assert flight.reached == [1, 1, 2, 3, 4]


@pytest.mark.flight
def test_another_current_item_before_the_mission() -> None:
    flight = MissionHarness(firmware=PX4)
    flight.load(takeoff(10), waypoint(20, 0, 10), waypoint(20, 20, 10))
    flight.set_current(2)
    flight.start()
    flight.ended()
    assert flight.reached == [2]


@pytest.mark.nightly
@pytest.mark.flight
def test_reset_counts_jumps_anew() -> None:
    flight = MissionHarness(firmware=PX4)
    flight.load(
        takeoff(10), waypoint(12, 0, 10), waypoint(0, 0, 10), item(CMD.DO_JUMP, 1, 1), waypoint(0, 12, 10)
    )
    flight.start()
    flight.reach(4)
    assert flight.reached == [0, 1, 2, 1, 2]
    flight.set_current(1, reset=True)
    flight.ended()
    assert flight.reached == [0, 1, 2, 1, 2, 1, 2, 1, 2, 4]


@pytest.mark.flight
def test_jumps_stay_counted_without_a_reset() -> None:
    flight = MissionHarness(firmware=PX4)
    flight.load(
        takeoff(10), waypoint(12, 0, 10), waypoint(0, 0, 10), item(CMD.DO_JUMP, 1, 1), waypoint(0, 12, 10)
    )
    flight.start()
    flight.reach(4)
    flight.set_current(1)
    flight.ended()
    assert flight.reached == [0, 1, 2, 1, 2, 1, 2, 4]


@pytest.mark.nightly
@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_a_pause_and_going_on(firmware: Firmware) -> None:
    flight = flying(firmware)
    assert flight.mission.pause()
    flight.run(6)
    place = flight.place
    flight.run(5)
    assert flight.distance(place) < 1.0
    assert flight.speed < 0.5
    assert flight.mission.state == STATE.PAUSED
    assert flight.mission.resume()
    flight.ended()
    assert flight.distance((0, 60)) < 4


@pytest.mark.flight
def test_time_stands_still_in_a_pause() -> None:
    flight = MissionHarness(firmware=PX4)
    flight.load(takeoff(10), item(CMD.NAV_DELAY, 10), waypoint(20, 0, 10))
    flight.start()
    flight.reach(1)
    flight.run(5)
    flight.mission.pause()
    flight.run(20)
    flight.mission.resume()
    assert flight.run_until(lambda: flight.mission.sequence == 2, timeout=9) > 3


@pytest.mark.flight
def test_a_pause_during_the_takeoff() -> None:
    flight = MissionHarness()
    flight.load(takeoff(30), waypoint(20, 0, 30))
    flight.start()
    flight.run_until(lambda: flight.height > 8, timeout=20)
    flight.mission.pause()
    flight.run(4)
    height = flight.height
    flight.run(4)
    assert flight.height == pytest.approx(height, abs=0.7)
    flight.mission.resume()
    flight.ended()


def test_without_a_mission_there_is_nothing_to_pause() -> None:
    flight = MissionHarness()
    assert not flight.mission.pause()
    assert not flight.mission.resume()


# Another mission in flight


@pytest.mark.flight
def test_ardupilot_flies_on_at_the_same_number() -> None:
    flight = flying()
    flight.load(takeoff(10), waypoint(0, -40, 10), waypoint(0, -60, 10))
    flight.run(0.2)
    assert flight.status_texts[-2:] == ["Auto mission changed, restarted command", "Mission: 2 WP"]
    assert flight.mission.sequence == 2
    flight.run_until(lambda: flight.mission.sequence == 3, timeout=60)
    assert flight.distance((0, -40)) < 5


@pytest.mark.flight
def test_ardupilot_does_not_mind_the_same_mission_again() -> None:
    flight = flying()
    flight.load(takeoff(10), waypoint(60, 0, 10), waypoint(60, 60, 10), waypoint(0, 60, 10))
    flight.run(0.2)
    assert flight.status_texts[-1] == "Flight plan received"
    assert flight.mission.sequence == 2
    flight.ended()
    assert flight.reached == [1, 2, 3, 4]


@pytest.mark.flight
def test_ardupilots_plane_flies_on_to_where_it_was_going() -> None:
    flight = MissionHarness(VehicleType.PLANE)
    flight.load(takeoff(40), waypoint(400, 0, 40), waypoint(400, 400, 40))
    flight.start()
    flight.reach(2)
    flight.load(takeoff(40), waypoint(0, 400, 40), waypoint(-400, 400, 40))
    flight.run_until(lambda: 2 in flight.reached, timeout=60)
    assert flight.distance((400, 0)) < 80


@pytest.mark.flight
def test_px4_begins_the_new_mission() -> None:
    flight = flying(PX4)
    flight.load(waypoint(0, -40, 10), waypoint(0, -60, 10))
    flight.run(0.2)
    assert flight.mission.sequence == 0
    flight.ended()
    assert flight.distance((0, -60)) < 5


@pytest.mark.flight
def test_ardupilot_keeps_the_mission_that_it_flies() -> None:
    flight = flying()
    assert flight.clear() == RESULT.ERROR
    assert flight.mission.exists
    flight.enter(HOLD)
    assert flight.clear() == RESULT.ACCEPTED
    assert flight.mission.state == STATE.NO_MISSION


@pytest.mark.flight
def test_px4_holds_when_its_mission_is_gone() -> None:
    flight = flying(PX4)
    assert flight.clear() == RESULT.ACCEPTED
    flight.run_until(lambda: flight.autopilot.mode.number == HOLD, timeout=2)
    assert flight.status_texts[-1] == "No valid mission available, loitering"
    assert flight.mission.state == STATE.NO_MISSION


@pytest.mark.flight
def test_a_shorter_mission_ends_it() -> None:
    flight = flying()
    flight.reach(4)
    flight.load(takeoff(10), waypoint(60, 0, 10))
    flight.ended(timeout=5)
    assert flight.status_texts[-1] == "Auto mission changed but failed to restart command"


@pytest.mark.flight
def test_disarming_ends_it() -> None:
    flight = flying()
    flight.autopilot.disarm("test")
    flight.run(0.5)
    assert not flight.mission.flying
    assert flight.mission.state == STATE.PAUSED


@pytest.mark.flight
def test_changes_are_reported() -> None:
    flight = flying(PX4)
    reported = [
        (message.seq, message.mission_state)
        for message in flight.sent
        if isinstance(message, common.MissionCurrent)
    ]
    assert reported[0] == (0, STATE.NOT_STARTED)
    assert reported[-1] == (1, STATE.ACTIVE)
