"""Mission items that navigate: waypoints, takeoffs, landings, returns, transitions and guided limits."""

from __future__ import annotations

from math import degrees, nan

import pytest

from mavstack.dialects import common
from mavstack.services.setpoints import LocalSetpoint, SetpointReceived
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, VehicleType
from tests.sim.autopilot.harness import LAND, MISSION, RETURN
from tests.sim.autopilot.mission.harness import (
    CMD,
    FRAME,
    GROUND,
    MissionHarness,
    fly_items,
    item,
    land,
    takeoff,
    waypoint,
)

ARDUPILOT, PX4 = Firmware.ARDUPILOT, Firmware.PX4
COPTER, PLANE, VTOL, ROVER = VehicleType.COPTER, VehicleType.PLANE, VehicleType.VTOL, VehicleType.ROVER


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_a_hold_time(firmware: Firmware) -> None:
    flight = fly_items(waypoint(10, 0, 10, param1=8), waypoint(20, 0, 10), firmware=firmware)
    flight.run_until(lambda: flight.distance((10, 0)) < 2, timeout=30)
    assert flight.run_until(lambda: flight.mission.sequence == flight.first + 2, timeout=12) > 7


@pytest.mark.flight
def test_px4_takes_an_acceptance_radius() -> None:
    flight = fly_items(waypoint(40, 0, 10, param2=15), waypoint(40, 40, 10), firmware=PX4)
    flight.reach(2)
    assert flight.distance((40, 0)) == pytest.approx(14, abs=2)


@pytest.mark.flight
def test_px4_takes_a_heading() -> None:
    flight = fly_items(waypoint(20, 0, 10, param4=135), firmware=PX4)
    flight.ended()
    assert degrees(flight.body.truth.yaw) == pytest.approx(135, abs=10)


@pytest.mark.flight
def test_a_copter_looks_where_it_flies_without_one() -> None:
    flight = fly_items(waypoint(0, 40, 10, param4=nan), firmware=PX4)
    flight.run(4)
    assert degrees(flight.body.truth.yaw) == pytest.approx(90, abs=15)


@pytest.mark.flight
def test_a_plane_passes_by_at_a_distance() -> None:
    flight = MissionHarness(PLANE)
    flight.load(takeoff(40), waypoint(400, 0, 40, param3=100), waypoint(400, 500, 40))
    flight.start()
    flight.reach(3, timeout=90)
    assert flight.distance((500, 0)) < 40


@pytest.mark.flight_cases(3)
@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(
    ("frame", "altitude"),
    [
        (FRAME.GLOBAL, DEFAULT_HOME.altitude + 15),
        (FRAME.GLOBAL_INT, DEFAULT_HOME.altitude + 15),
        (FRAME.GLOBAL_RELATIVE_ALT, 15),
        (FRAME.GLOBAL_RELATIVE_ALT_INT, 15),
        (FRAME.GLOBAL_TERRAIN_ALT, 15),
        (FRAME.GLOBAL_TERRAIN_ALT_INT, 15),
        (FRAME.MISSION, DEFAULT_HOME.altitude + 15),
    ],
)
def test_altitudes_are_relative_to_the_origin_of_their_frame(frame: int, altitude: float) -> None:
    flight = fly_items(item(CMD.NAV_WAYPOINT, at=(15, 0, altitude), frame=frame))
    flight.ended()
    flight.run(3)
    assert flight.height == pytest.approx(15, abs=1.2)
    assert flight.distance((15, 0)) < 2.5


@pytest.mark.flight
def test_no_place_means_here() -> None:
    flight = fly_items(item(CMD.NAV_WAYPOINT, 0, 0, 0, 0, 0, 0, 14, frame=FRAME.GLOBAL_RELATIVE_ALT))
    flight.ended()
    flight.run(3)
    assert flight.distance() < 2
    assert flight.height == pytest.approx(14, abs=1.2)


@pytest.mark.flight
def test_climbing_on_the_way() -> None:
    flight = MissionHarness(PLANE)
    flight.load(takeoff(40), item(CMD.NAV_CONTINUE_AND_CHANGE_ALT, 1, at=(0, 0, 80)), waypoint(0, 0, 80))
    flight.start()
    flight.reach(3, timeout=90)
    assert flight.height > 70


@pytest.mark.flight
def test_a_landing_at_a_place_and_another_start() -> None:
    flight = fly_items(land(20, 0), takeoff(6), waypoint(0, 0, 6))
    flight.reach(3, timeout=60)
    assert flight.height < 0.3
    assert flight.distance((20, 0)) < 2.5
    flight.ended()
    assert flight.distance() < 2.5
    assert flight.height > 5


@pytest.mark.flight
def test_the_landed_state_reports_takeoff_and_landing() -> None:
    flight = MissionHarness()
    flight.load(takeoff(10), land())
    flight.start()
    states = []
    while flight.autopilot.armed:
        flight.run(0.5)
        states.append(flight.autopilot.landed_state)
        assert len(states) < 200
    states = [state for at, state in enumerate(states) if at == 0 or states[at - 1] != state]
    landed = common.MavLandedState
    assert [state for state in states if state != landed.IN_AIR][-3:] == [
        landed.TAKEOFF,
        landed.LANDING,
        landed.ON_GROUND,
    ]


@pytest.mark.nightly
@pytest.mark.flight
def test_returning_as_an_item() -> None:
    flight = fly_items(waypoint(30, 0, 10), item(CMD.NAV_RETURN_TO_LAUNCH))
    flight.run_until(lambda: not flight.autopilot.armed, timeout=120)
    assert flight.distance() < 2.5
    assert flight.autopilot.mode.name == "MODE2"


@pytest.mark.parametrize(("kind", "firmware"), [(COPTER, PX4), (ROVER, ARDUPILOT)])
def test_returning_by_the_mode_for_it(kind: VehicleType, firmware: Firmware) -> None:
    flight = MissionHarness(kind, firmware)
    flight.load(waypoint(15, 0, 8), item(CMD.NAV_RETURN_TO_LAUNCH))
    flight.start()
    flight.run_until(lambda: flight.autopilot.mode.number == RETURN, timeout=90)


@pytest.mark.flight
def test_a_mode_that_is_chosen_as_the_mission_ends_stays() -> None:
    flight = MissionHarness(COPTER, PX4)
    flight.load(waypoint(15, 0, 8))
    flight.start()
    flight.ended()
    assert flight.autopilot.mode.number == MISSION  # for a tick still
    flight.autopilot.enter(LAND, "commanded", commanded=True)
    flight.run(2)
    assert flight.autopilot.mode.number == LAND


@pytest.mark.flight
def test_a_vtol_takes_off_flies_hovers_and_lands() -> None:
    flight = MissionHarness(VTOL, PX4)
    flight.load(
        takeoff(40, CMD.NAV_VTOL_TAKEOFF),
        waypoint(500, 0, 40),
        item(CMD.DO_VTOL_TRANSITION, common.MavVtolState.MC),
        waypoint(500, 100, 40),
        item(CMD.NAV_VTOL_LAND, at=(500, 100, 0)),
    )
    flight.start()
    flight.reach(1)
    assert flight.body.flies_forward
    flight.reach(3)
    assert not flight.body.flies_forward
    flight.ended()
    assert flight.height < 0.4
    assert flight.distance((500, 100)) < 5


@pytest.mark.flight
def test_ardupilots_vtol_flies_waypoints_forward_unless_hovering_was_commanded() -> None:
    flight = MissionHarness(VTOL)
    hover = item(CMD.DO_VTOL_TRANSITION, common.MavVtolState.MC)
    flight.load(takeoff(40), waypoint(400, 0, 40), hover, waypoint(400, 80, 40))
    flight.start()
    flight.reach(2)
    flight.run(8)
    assert flight.body.flies_forward
    flight.reach(4)
    flight.run(10)
    assert not flight.body.flies_forward


def test_turning_at_a_speed() -> None:
    flight = MissionHarness(ROVER)
    flight.load(waypoint(10, 0, 0), item(CMD.NAV_SET_YAW_SPEED, 90, 1.5), waypoint(10, 20, 0))
    flight.start()
    flight.reach(3)
    assert degrees(flight.body.truth.yaw) == pytest.approx(90, abs=10)


def test_waiting_for_an_altitude() -> None:
    flight = MissionHarness(PLANE)
    flight.load(item(CMD.NAV_ALTITUDE_WAIT, DEFAULT_HOME.altitude + 50), takeoff(60))
    flight.start()
    flight.run(5)
    assert flight.mission.sequence == 1
    flight.body.place(0.0, 0.0, -60.0, 0.0)
    flight.reach(2, timeout=2)


@pytest.mark.flight
def test_placing_the_payload() -> None:
    flight = fly_items(
        item(CMD.DO_GRIPPER, 1, 1), item(CMD.NAV_PAYLOAD_PLACE, at=(10, 0, 0)), waypoint(0, 0, 10)
    )
    flight.run_until(lambda: flight.autopilot.payload.gripper_closed, timeout=5)
    flight.run_until(lambda: not flight.autopilot.payload.gripper_closed, timeout=60)
    assert flight.height < 2
    flight.reach(4)
    assert flight.height > 8


def test_being_guided_until_a_limit() -> None:
    flight = fly_items(
        item(CMD.DO_GUIDED_LIMITS, 0, 0, 0, 15), item(CMD.NAV_GUIDED_ENABLE, 1), waypoint(0, 0, 10)
    )
    flight.reach(3)
    flight.run(1)
    flight.vehicle.handle_event(SetpointReceived(GROUND, LocalSetpoint(position=(0.0, 40.0, -10.0))))
    flight.reach(4, timeout=30)
    assert flight.distance() == pytest.approx(15, abs=3)
