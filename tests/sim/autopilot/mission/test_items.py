"""The effect of each mission item."""

from __future__ import annotations

from math import atan2, degrees, hypot, inf, nan, pi, radians, remainder

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, PlanType
from mavstack.services.setpoints import LocalSetpoint, SetpointReceived
from mavstack.sim.autopilot.mission.ardupilot import NAMES
from mavstack.sim.autopilot.mission.px4 import PLACED, PLACELESS
from mavstack.sim.autopilot.mission.scripts import SCRIPTS
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, VehicleType
from tests.sim.autopilot.harness import LAND, MISSION, RETURN
from tests.sim.autopilot.mission.harness import (
    CMD,
    FRAME,
    GROUND,
    MissionHarness,
    item,
    land,
    takeoff,
    waypoint,
)

ARDUPILOT, PX4 = Firmware.ARDUPILOT, Firmware.PX4
COPTER, PLANE, VTOL, ROVER, SUB = (VehicleType(name) for name in ("copter", "plane", "vtol", "rover", "sub"))
#: Marks, jumps (the route's), and what these vehicles do not have.
_WITHOUT_SCRIPT = {
    CMD.DO_JUMP,
    CMD.DO_JUMP_TAG,
    CMD.JUMP_TAG,
    CMD.DO_LAND_START,
    CMD.DO_RETURN_PATH_START,
    CMD.DO_GO_AROUND,
    CMD.DO_DIGICAM_CONFIGURE,
    CMD.DO_INVERTED_FLIGHT,
    CMD.DO_AUTOTUNE_ENABLE,
    CMD.DO_SET_REVERSE,
    CMD.DO_ENGINE_CONTROL,
    CMD.DO_SET_RESUME_REPEAT_DIST,
    CMD.DO_MOUNT_CONFIGURE,
    CMD.DO_GIMBAL_MANAGER_CONFIGURE,
    CMD.SET_CAMERA_MODE,
    CMD.SET_CAMERA_SOURCE,
    CMD.DO_CONTROL_VIDEO,
    CMD.DO_SET_ROI_WPNEXT_OFFSET,
}


def test_what_an_upload_may_hold_has_a_script() -> None:
    assert (set(NAMES) | PLACED | PLACELESS) - set(SCRIPTS) == _WITHOUT_SCRIPT


def fly(
    *items: MissionItem,
    firmware: Firmware = ARDUPILOT,
    kind: VehicleType = COPTER,
    **flight_parameters: float,
) -> MissionHarness:
    """In the air at 10 m, and then these items."""
    flight = MissionHarness(kind, firmware, **flight_parameters)
    flight.load(takeoff(10), *items)
    flight.start()
    flight.run_until(lambda: flight.first in flight.reached, timeout=60)
    return flight


def do(*items: MissionItem, firmware: Firmware = ARDUPILOT) -> MissionHarness:
    """Do something on the ground, before a take-off."""
    flight = MissionHarness(COPTER, firmware)
    flight.load(takeoff(2), *items, waypoint(8, 0, 2))
    flight.start()
    flight.ended()
    return flight


# Waypoints


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_a_hold_time(firmware: Firmware) -> None:
    flight = fly(waypoint(10, 0, 10, param1=8), waypoint(20, 0, 10), firmware=firmware)
    flight.run_until(lambda: flight.distance((10, 0)) < 2, timeout=30)
    assert flight.run_until(lambda: flight.mission.sequence == flight.first + 2, timeout=12) > 7


@pytest.mark.flight
def test_px4_takes_an_acceptance_radius() -> None:
    flight = fly(waypoint(40, 0, 10, param2=15), waypoint(40, 40, 10), firmware=PX4)
    flight.reach(2)
    assert flight.distance((40, 0)) == pytest.approx(14, abs=2)


@pytest.mark.flight
def test_px4_takes_a_heading() -> None:
    flight = fly(waypoint(20, 0, 10, param4=135), firmware=PX4)
    flight.ended()
    assert degrees(flight.body.truth.yaw) == pytest.approx(135, abs=10)


@pytest.mark.flight
def test_a_copter_looks_where_it_flies_without_one() -> None:
    flight = fly(waypoint(0, 40, 10, param4=nan), firmware=PX4)
    flight.run(4)
    assert degrees(flight.body.truth.yaw) == pytest.approx(90, abs=15)


@pytest.mark.flight
def test_a_plane_passes_by_at_a_distance() -> None:
    flight = MissionHarness(PLANE)
    flight.load(takeoff(40), waypoint(400, 0, 40, param3=100), waypoint(400, 500, 40))
    flight.start()
    flight.reach(3, timeout=90)
    assert flight.distance((500, 0)) < 40


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
def test_altitudes_count_from_where_the_frame_says(frame: int, altitude: float) -> None:
    flight = fly(item(CMD.NAV_WAYPOINT, at=(15, 0, altitude), frame=frame))
    flight.ended()
    flight.run(3)
    assert flight.height == pytest.approx(15, abs=1.2)
    assert flight.distance((15, 0)) < 2.5


@pytest.mark.flight
def test_no_place_means_here() -> None:
    flight = fly(item(CMD.NAV_WAYPOINT, 0, 0, 0, 0, 0, 0, 14, frame=FRAME.GLOBAL_RELATIVE_ALT))
    flight.ended()
    flight.run(3)
    assert flight.distance() < 2
    assert flight.height == pytest.approx(14, abs=1.2)


# Staying


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_loitering_without_end(firmware: Firmware) -> None:
    flight = fly(item(CMD.NAV_LOITER_UNLIM, at=(15, 0, 10)), waypoint(0, 0, 10), firmware=firmware)
    flight.run(40)
    assert flight.distance((15, 0)) < 2.5
    assert flight.mission.sequence == flight.first + 1


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_loitering_for_a_time(firmware: Firmware) -> None:
    flight = fly(item(CMD.NAV_LOITER_TIME, 12, at=(10, 0, 10)), waypoint(0, 0, 10), firmware=firmware)
    flight.run_until(lambda: flight.distance((10, 0)) < 2, timeout=30)
    assert flight.run_until(lambda: flight.mission.sequence == flight.first + 2, timeout=16) > 11


def turned(flight: MissionHarness, centre: tuple[float, float], until: int) -> float:
    """How often it goes round a centre until an item is the current one."""
    total, last = 0.0, None
    while flight.mission.sequence != until:
        north, east = flight.place
        bearing = atan2(east - centre[1], north - centre[0])
        if last is not None:
            total += remainder(bearing - last, 2 * pi)
        last = bearing
        flight.run(0.2)
        assert abs(total) < 60
    return total / (2 * pi)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(("radius", "direction"), [(12.0, 1), (-12.0, -1)])
def test_turns_of_a_copter(radius: float, direction: int) -> None:
    flight = fly(item(CMD.NAV_LOITER_TURNS, 2, 0, radius, at=(0, 0, 10)), waypoint(0, 0, 10))
    flight.run_until(lambda: flight.distance() > 10, timeout=30)
    assert turned(flight, (0, 0), 3) * direction == pytest.approx(2, abs=0.35)


@pytest.mark.flight
def test_turns_of_a_plane() -> None:
    flight = MissionHarness(PLANE)
    flight.load(takeoff(40), item(CMD.NAV_LOITER_TURNS, 2, 0, 80, at=(300, 0, 40)), waypoint(0, 0, 40))
    flight.start()
    flight.reach(2)
    flight.run_until(lambda: abs(flight.distance((300, 0)) - 80) < 15, timeout=60)
    assert turned(flight, (300, 0), 3) == pytest.approx(2, abs=0.4)


@pytest.mark.flight
def test_a_plane_circles_while_it_waits() -> None:
    flight = MissionHarness(PLANE, PX4)
    flight.load(takeoff(40), item(CMD.NAV_LOITER_TIME, 30, 0, 70, at=(300, 0, 40)), waypoint(0, 0, 40))
    flight.start()
    flight.reach(1)
    flight.run_until(lambda: abs(flight.distance((300, 0)) - 70) < 15, timeout=60)
    begun = flight.now
    while flight.mission.sequence == 1:
        flight.run(0.5)
        assert abs(flight.distance((300, 0)) - 70) < 25
    assert 28 < flight.now - begun < 40


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", [COPTER, PLANE])
def test_loitering_to_an_altitude(kind: VehicleType) -> None:
    flight = MissionHarness(kind)
    flight.load(takeoff(20), item(CMD.NAV_LOITER_TO_ALT, 0, 60, at=(100, 0, 70)), waypoint(200, 0, 70))
    flight.start()
    flight.reach(3, timeout=150)
    assert flight.height == pytest.approx(70, abs=9)
    assert flight.distance((100, 0)) < 80


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_a_delay(firmware: Firmware) -> None:
    flight = fly(item(CMD.NAV_DELAY, 8), waypoint(10, 0, 10), firmware=firmware)
    assert flight.run_until(lambda: flight.mission.sequence == flight.first + 2, timeout=9) > 7


@pytest.mark.flight
def test_a_delay_until_a_time_of_day() -> None:
    flight = MissionHarness(disarm_delay=inf)
    later = (flight.now + 30) % 86400
    hour, minute, second = later // 3600, later % 3600 // 60, later % 60 // 1
    flight.load(item(CMD.NAV_DELAY, -1, hour, minute, second), takeoff(10))
    flight.start()
    assert flight.run_until(lambda: flight.mission.sequence == 2, timeout=32) == pytest.approx(30, abs=1.5)
    assert flight.height < 0.5


# Up and down


@pytest.mark.flight
def test_climbing_on_the_way() -> None:
    flight = MissionHarness(PLANE)
    flight.load(takeoff(40), item(CMD.NAV_CONTINUE_AND_CHANGE_ALT, 1, at=(0, 0, 80)), waypoint(0, 0, 80))
    flight.start()
    flight.reach(3, timeout=90)
    assert flight.height > 70


@pytest.mark.flight
def test_a_landing_at_a_place_and_another_start() -> None:
    flight = fly(land(20, 0), takeoff(6), waypoint(0, 0, 6))
    flight.reach(3, timeout=60)
    assert flight.height < 0.3
    assert flight.distance((20, 0)) < 2.5
    flight.ended()
    assert flight.distance() < 2.5
    assert flight.height > 5


@pytest.mark.flight
def test_taking_off_and_landing_is_told_by_the_landed_state() -> None:
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


@pytest.mark.flight
def test_returning_as_an_item() -> None:
    flight = fly(waypoint(30, 0, 10), item(CMD.NAV_RETURN_TO_LAUNCH))
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
def test_ardupilots_vtol_flies_waypoints_forward_unless_it_was_told_to_hover() -> None:
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
    flight = fly(item(CMD.DO_GRIPPER, 1, 1), item(CMD.NAV_PAYLOAD_PLACE, at=(10, 0, 0)), waypoint(0, 0, 10))
    flight.run_until(lambda: flight.autopilot.payload.gripper_closed, timeout=5)
    flight.run_until(lambda: not flight.autopilot.payload.gripper_closed, timeout=60)
    assert flight.height < 2
    flight.reach(4)
    assert flight.height > 8


def test_being_guided_until_a_limit() -> None:
    flight = fly(item(CMD.DO_GUIDED_LIMITS, 0, 0, 0, 15), item(CMD.NAV_GUIDED_ENABLE, 1), waypoint(0, 0, 10))
    flight.reach(3)
    flight.run(1)
    flight.vehicle.handle_event(SetpointReceived(GROUND, LocalSetpoint(position=(0.0, 40.0, -10.0))))
    flight.reach(4, timeout=30)
    assert flight.distance() == pytest.approx(15, abs=3)


# Conditions


@pytest.mark.flight
def test_a_condition_of_time_holds_up_what_follows_but_not_the_flight() -> None:
    flight = fly(
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
    flight = fly(item(CMD.CONDITION_DELAY, 4), waypoint(60, 0, 10), firmware=PX4)
    flight.run(3.5)
    assert flight.mission.sequence == 1
    flight.reach(2, timeout=2)


@pytest.mark.flight
def test_a_condition_of_distance() -> None:
    flight = fly(
        waypoint(5, 0, 10),
        item(CMD.CONDITION_DISTANCE, 30),
        item(CMD.DO_SET_SERVO, 9, 1900),
        waypoint(90, 0, 10),
    )
    flight.run_until(lambda: 9 in flight.autopilot.payload.servos, timeout=60)
    assert flight.distance((90, 0)) == pytest.approx(30, abs=3)


@pytest.mark.flight
def test_a_heading_holds_until_the_next_waypoint() -> None:
    flight = fly(waypoint(5, 0, 10), item(CMD.CONDITION_YAW, 90), waypoint(80, 0, 10), waypoint(0, 0, 10))
    flight.reach(4)
    flight.run(6)
    assert degrees(flight.body.truth.yaw) == pytest.approx(90, abs=8)
    flight.reach(5)
    flight.run(5)
    assert abs(degrees(flight.body.truth.yaw)) == pytest.approx(180, abs=15)


@pytest.mark.flight
def test_a_relative_heading() -> None:
    flight = fly(waypoint(5, 0, 10), item(CMD.CONDITION_YAW, 45, 0, -1, 1), waypoint(80, 0, 10))
    before = flight.body.truth.yaw
    flight.reach(4)
    flight.run(6)
    assert degrees(remainder(flight.body.truth.yaw - before, 2 * pi)) == pytest.approx(-45, abs=15)


# Speed, home, what is looked at


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_another_speed(firmware: Firmware) -> None:
    flight = fly(item(CMD.DO_CHANGE_SPEED, 1, 3, -1), waypoint(60, 0, 10), firmware=firmware)
    flight.run(8)
    assert flight.speed == pytest.approx(3, abs=0.4)
    flight.ended()
    assert flight.mission.flying or flight.autopilot.maneuvers.speed is None


@pytest.mark.flight
def test_speeds_up_and_down_and_the_usual_ones_again() -> None:
    flight = fly(
        item(CMD.DO_CHANGE_SPEED, common.SpeedType.CLIMB_SPEED, 1.0),
        item(CMD.DO_CHANGE_SPEED, common.SpeedType.DESCENT_SPEED, 0.5),
        waypoint(0, 0, 20),
        waypoint(0, 0, 15),
        item(CMD.DO_CHANGE_SPEED, common.SpeedType.DESCENT_SPEED, -2),
        waypoint(0, 0, 5),
    )
    flight.reach(4)
    flight.run(4)
    assert flight.body.truth.velocity_down == pytest.approx(-1.0, abs=0.2)
    flight.reach(5)
    flight.run(4)
    assert flight.body.truth.velocity_down == pytest.approx(0.5, abs=0.15)
    flight.reach(7)
    flight.run(3)
    assert flight.body.truth.velocity_down > 1.0


@pytest.mark.flight
def test_home_elsewhere() -> None:
    flight = do(item(CMD.DO_SET_HOME, 0, at=(100, 50, DEFAULT_HOME.altitude - 1), frame=FRAME.GLOBAL))
    north, east, down = flight.autopilot.home_position
    assert (north, east) == pytest.approx((100, 50), abs=0.5)
    assert down == pytest.approx(1, abs=0.1)


@pytest.mark.flight
def test_home_here() -> None:
    flight = fly(waypoint(20, 0, 10), item(CMD.DO_SET_HOME, 1), waypoint(0, 0, 10))
    flight.reach(4)
    assert flight.autopilot.home_position[0] == pytest.approx(20, abs=3)


@pytest.mark.flight
def test_a_region_of_interest() -> None:
    flight = fly(
        item(CMD.DO_SET_ROI_LOCATION, at=(30, 100, 0)),
        waypoint(60, 0, 10),
        item(CMD.DO_SET_ROI_NONE),
        waypoint(0, 0, 10),
    )
    flight.reach(3)
    flight.run(5)
    wanted = atan2(100 - flight.place[1], 30 - flight.place[0])
    assert abs(degrees(remainder(flight.body.truth.yaw - wanted, 2 * pi))) < 8
    assert flight.autopilot.payload.gimbal.pitch == pytest.approx(-atan2(10, hypot(100, 30)), abs=0.05)
    flight.reach(5)
    flight.run(5)
    assert flight.autopilot.payload.region_of_interest is None
    assert abs(degrees(flight.body.truth.yaw)) == pytest.approx(180, abs=15)


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize(
    ("region", "expected"),
    [
        (item(CMD.DO_SET_ROI, common.MavRoi.LOCATION, at=(30, 5, 0)), (30, 5)),
        (item(CMD.DO_SET_ROI, common.MavRoi.WPNEXT), (8, 0)),
        (item(CMD.DO_SET_ROI, common.MavRoi.WPINDEX, 3), (8, 0)),
    ],
)
def test_regions_by_mode(region: MissionItem, expected: tuple[float, float]) -> None:
    flight = do(region, firmware=ARDUPILOT)
    found = flight.autopilot.payload.region_of_interest
    assert found is not None
    assert found[:2] == pytest.approx(expected, abs=0.2)


@pytest.mark.flight
def test_the_fence_is_switched() -> None:
    flight = do(item(CMD.DO_FENCE_ENABLE, 1))
    assert flight.autopilot.fence.switched is True
    assert flight.autopilot.fence.enabled
    assert not do(item(CMD.DO_FENCE_ENABLE, 0)).autopilot.fence.enabled


# Payload


@pytest.mark.flight
def test_servos_and_relays() -> None:
    payload = do(item(CMD.DO_SET_SERVO, 9, 1900), item(CMD.DO_SET_RELAY, 2, 1)).autopilot.payload
    assert payload.servos == {9: 1900}
    assert payload.relays == {2: True}


@pytest.mark.flight
def test_servos_and_relays_to_and_fro() -> None:
    flight = fly(
        item(CMD.DO_REPEAT_SERVO, 9, 1900, 2, 2), item(CMD.DO_REPEAT_RELAY, 1, 2, 2), item(CMD.NAV_DELAY, 60)
    )
    servos, relays = [], []
    for _ in range(50):
        flight.run(0.1)
        servos.append(flight.autopilot.payload.servos.get(9))
        relays.append(flight.autopilot.payload.relays.get(1))
    assert [value for at, value in enumerate(servos) if at and servos[at - 1] != value][:3] == [
        1500,
        1900,
        1500,
    ]
    assert [value for at, value in enumerate(relays) if at and relays[at - 1] != value][-3:] == [
        False,
        True,
        False,
    ]


@pytest.mark.flight
def test_actuators() -> None:
    flight = do(item(CMD.DO_SET_ACTUATOR, 1, -1, nan, 0.5, nan, nan), firmware=PX4)
    assert flight.autopilot.payload.servos == {1: 2000, 2: 1000, 4: 1750}


@pytest.mark.parametrize("firmware", list(Firmware))
def test_gripper_and_winch(firmware: Firmware) -> None:
    payload = do(
        item(CMD.DO_GRIPPER, 1, common.GripperActions.GRAB), item(CMD.DO_WINCH, 1, 1, 3, 1), firmware=firmware
    ).autopilot.payload
    assert payload.gripper_closed
    assert payload.winch == pytest.approx(3)


def test_sprayer_parachute_and_functions() -> None:
    payload = do(
        item(CMD.DO_SPRAYER, 1),
        item(CMD.DO_PARACHUTE, 1),
        item(CMD.DO_AUX_FUNCTION, 28, 2),
        item(CMD.DO_AUX_FUNCTION, 19, 2),
        item(CMD.DO_AUX_FUNCTION, 9, 2),
    ).autopilot.payload
    assert payload.sprayer
    assert payload.parachute_enabled
    assert payload.relays == {0: True}
    assert payload.gripper_closed
    assert payload.images == 1


def test_the_parachute_ends_the_flight() -> None:
    flight = fly(item(CMD.DO_PARACHUTE, 1), item(CMD.DO_PARACHUTE, 2), waypoint(50, 0, 10))
    flight.run_until(lambda: not flight.autopilot.armed, timeout=10)
    assert flight.autopilot.payload.parachute_released


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_pictures_by_distance(firmware: Firmware) -> None:
    flight = fly(
        item(CMD.DO_SET_CAM_TRIGG_DIST, 10), waypoint(50, 0, 10), item(CMD.DO_SET_CAM_TRIGG_DIST, 0),
        waypoint(0, 0, 10), firmware=firmware,
    )  # fmt: skip
    flight.ended()
    assert flight.autopilot.payload.images in (5, 6)
    pictures = [message for message in flight.sent if isinstance(message, common.CameraImageCaptured)]
    assert [picture.image_index for picture in pictures] == list(range(len(pictures)))


@pytest.mark.flight
def test_pictures_by_time() -> None:
    flight = fly(
        item(CMD.IMAGE_START_CAPTURE, 0, 2, 0, nan),
        item(CMD.NAV_DELAY, 9),
        item(CMD.IMAGE_STOP_CAPTURE),
        item(CMD.NAV_DELAY, 9),
        firmware=PX4,
    )
    flight.ended()
    assert flight.autopilot.payload.images == 5
    flight = do(item(CMD.DO_SET_CAM_TRIGG_INTERVAL, 500), item(CMD.NAV_DELAY, 2.2), firmware=PX4)
    assert flight.autopilot.payload.images >= 5


@pytest.mark.flight
def test_a_few_pictures_one_picture_and_video() -> None:
    payload = do(item(CMD.IMAGE_START_CAPTURE, 0, 0.1, 3), item(CMD.NAV_DELAY, 2)).autopilot.payload
    assert payload.images == 3
    assert do(item(CMD.DO_DIGICAM_CONTROL, 0, 0, 0, 0, 1)).autopilot.payload.images == 1
    assert do(item(CMD.VIDEO_START_CAPTURE)).autopilot.payload.recording
    assert not do(item(CMD.VIDEO_START_CAPTURE), item(CMD.VIDEO_STOP_CAPTURE)).autopilot.payload.recording
    payload = do(item(CMD.SET_CAMERA_ZOOM, 2, 40), item(CMD.SET_CAMERA_FOCUS, 2, 60)).autopilot.payload
    assert (payload.zoom, payload.focus) == (40, 60)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_the_gimbal(firmware: Firmware) -> None:
    gimbal = do(item(CMD.DO_MOUNT_CONTROL, -45, 5, 30), firmware=firmware).autopilot.payload.gimbal
    assert (gimbal.pitch, gimbal.roll, gimbal.yaw) == pytest.approx(
        [radians(angle) for angle in (-45, 5, 30)]
    )
    manager = item(CMD.DO_GIMBAL_MANAGER_PITCHYAW, -20, nan, nan, nan)
    gimbal = do(item(CMD.DO_MOUNT_CONTROL, -45, 5, 30), manager, firmware=firmware).autopilot.payload.gimbal
    assert (gimbal.pitch, gimbal.yaw) == pytest.approx((radians(-20), radians(30)))


def test_px4_disarms_by_an_item() -> None:
    flight = MissionHarness(firmware=PX4, disarm_delay=inf, land_disarm_delay=inf)
    flight.load(takeoff(4), land(), item(CMD.COMPONENT_ARM_DISARM, 0))
    flight.start()
    flight.run_until(lambda: not flight.autopilot.armed, timeout=60)


# Marks


def test_the_nearest_start_of_a_landing() -> None:
    flight = MissionHarness(PLANE)
    assert flight.mission.landing_start() is None
    near, far = (item(CMD.DO_LAND_START, at=(north, 0, 30)) for north in (100, 900))
    flight.load(takeoff(40), far, waypoint(0, 0, 40), near, waypoint(0, 0, 40))
    assert flight.mission.landing_start() == 4


@pytest.mark.flight
def test_texts_of_ardupilot() -> None:
    flight = fly(waypoint(10, 0, 10), item(CMD.DO_SET_SERVO, 9, 1900), waypoint(0, 0, 10))
    flight.ended()
    assert flight.status_texts == [
        "Flight plan received",
        "Mission: 1 Takeoff",
        "Mission: 2 WP",
        "Reached command #2",
        "Mission: 3 SetServo",
        "Mission: 4 WP",
        "Reached command #4",
    ]
    assert flight.reached == [1, 2, 4]


@pytest.mark.flight
def test_texts_of_a_rover_that_waits() -> None:
    flight = MissionHarness(ROVER)
    flight.load(waypoint(10, 0, 0, param1=3))
    flight.start()
    flight.ended()
    assert "Reached waypoint #1. Loiter for 3 seconds" in flight.status_texts


@pytest.mark.flight
def test_an_unknown_item_in_the_store_is_passed_over() -> None:
    flight = MissionHarness(firmware=PX4)
    from mavstack.services.mission import Plan

    flight.server.replace(Plan.of([takeoff(5), item(31999), waypoint(5, 0, 5)], PlanType.MISSION))
    flight.start()
    flight.ended()
    assert flight.reached == [0, 1, 2]
