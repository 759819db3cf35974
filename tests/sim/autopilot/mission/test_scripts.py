"""Scripts of mission items: every item has one, and markers and unknown items do nothing."""

from __future__ import annotations

import pytest

from mavstack.services.mission import PlanType
from mavstack.sim.autopilot.mission.ardupilot import NAMES
from mavstack.sim.autopilot.mission.px4 import PLACED, PLACELESS
from mavstack.sim.autopilot.mission.scripts import SCRIPTS
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.autopilot.mission.harness import (
    CMD,
    MissionHarness,
    fly_items,
    item,
    takeoff,
    waypoint,
)

ARDUPILOT, PX4 = Firmware.ARDUPILOT, Firmware.PX4
PLANE, ROVER = VehicleType.PLANE, VehicleType.ROVER


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


def test_the_nearest_start_of_a_landing() -> None:
    flight = MissionHarness(PLANE)
    assert flight.mission.landing_start() is None
    near, far = (item(CMD.DO_LAND_START, at=(north, 0, 30)) for north in (100, 900))
    flight.load(takeoff(40), far, waypoint(0, 0, 40), near, waypoint(0, 0, 40))
    assert flight.mission.landing_start() == 4


@pytest.mark.flight
def test_texts_of_ardupilot() -> None:
    flight = fly_items(waypoint(10, 0, 10), item(CMD.DO_SET_SERVO, 9, 1900), waypoint(0, 0, 10))
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
