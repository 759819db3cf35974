"""Which missions are refused, and how."""

from __future__ import annotations

from math import inf, nan
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, PlanType
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.autopilot.mission.harness import (
    CMD,
    FRAME,
    RESULT,
    MissionHarness,
    item,
    land,
    takeoff,
    waypoint,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

ARDUPILOT, PX4 = Firmware.ARDUPILOT, Firmware.PX4
PLACED = item(CMD.NAV_WAYPOINT, at=(10, 0, 20))


@pytest.fixture(scope="module", params=list(Firmware))
def flight(request: pytest.FixtureRequest) -> Iterator[MissionHarness]:
    return MissionHarness(VehicleType.COPTER, request.param)


def check(flight: MissionHarness, wanted: MissionItem, kind: int = PlanType.MISSION) -> int:
    return flight.mission.check(kind, 1, wanted)


CASES = [
    (PLACED, RESULT.ACCEPTED, RESULT.ACCEPTED),
    (item(60000), RESULT.UNSUPPORTED, RESULT.UNSUPPORTED),
    (item(CMD.NAV_SPLINE_WAYPOINT, at=(1, 1, 9)), RESULT.ACCEPTED, RESULT.UNSUPPORTED),
    (item(CMD.NAV_LOITER_TURNS, at=(1, 1, 9)), RESULT.ACCEPTED, RESULT.UNSUPPORTED),
    (item(CMD.DO_SET_SERVO, 9, 1900), RESULT.ACCEPTED, RESULT.UNSUPPORTED),
    (item(CMD.DO_SET_ACTUATOR, 0.5), RESULT.UNSUPPORTED, RESULT.ACCEPTED),
    (item(CMD.DO_JUMP_TAG, 1, 1), RESULT.ACCEPTED, RESULT.UNSUPPORTED),
    (item(CMD.NAV_DELAY, 3, -1, -1, -1), RESULT.ACCEPTED, RESULT.ACCEPTED),
    (item(CMD.NAV_WAYPOINT, inf, at=(1, 1, 9)), RESULT.INVALID_PARAM1, RESULT.INVALID_PARAM1),
    (item(CMD.NAV_WAYPOINT, 0, inf, at=(1, 1, 9)), RESULT.INVALID_PARAM2, RESULT.INVALID_PARAM2),
    (item(CMD.NAV_WAYPOINT, 0, nan, at=(1, 1, 9)), RESULT.INVALID_PARAM2, RESULT.ACCEPTED),
    (item(CMD.NAV_WAYPOINT, 0, 0, 0, nan, at=(1, 1, 9)), RESULT.ACCEPTED, RESULT.ACCEPTED),
    (
        item(CMD.NAV_WAYPOINT, 0, 0, 0, 0, 91.0, 8.0, 9.0, frame=3),
        RESULT.INVALID_PARAM5_X,
        RESULT.INVALID_PARAM5_X,
    ),
    (
        item(CMD.NAV_WAYPOINT, 0, 0, 0, 0, 47.0, 181.0, 9.0, frame=3),
        RESULT.INVALID_PARAM6_Y,
        RESULT.INVALID_PARAM6_Y,
    ),
    (
        item(CMD.NAV_WAYPOINT, 0, 0, 0, 0, 47.0, 8.0, 1e6, frame=3),
        RESULT.INVALID_PARAM7,
        RESULT.INVALID_PARAM7,
    ),
    (item(CMD.NAV_TAKEOFF, 0, 0, 0, nan, nan, nan, 9.0, frame=3), RESULT.INVALID_PARAM5_X, RESULT.ACCEPTED),
]


@pytest.mark.parametrize(("wanted", "ardupilot", "px4"), CASES)
def test_items(flight: MissionHarness, wanted: MissionItem, ardupilot: int, px4: int) -> None:
    assert check(flight, wanted) == (ardupilot if flight.firmware is ARDUPILOT else px4)


FRAMES = {
    FRAME.GLOBAL: (RESULT.ACCEPTED, RESULT.ACCEPTED),
    FRAME.GLOBAL_INT: (RESULT.ACCEPTED, RESULT.ACCEPTED),
    FRAME.GLOBAL_RELATIVE_ALT_INT: (RESULT.ACCEPTED, RESULT.ACCEPTED),
    FRAME.GLOBAL_TERRAIN_ALT: (RESULT.ACCEPTED, RESULT.UNSUPPORTED_FRAME),
    FRAME.LOCAL_NED: (RESULT.UNSUPPORTED_FRAME, RESULT.UNSUPPORTED_FRAME),
    FRAME.BODY_NED: (RESULT.UNSUPPORTED_FRAME, RESULT.UNSUPPORTED_FRAME),
    FRAME.MISSION: (RESULT.ACCEPTED, RESULT.UNSUPPORTED),
}


@pytest.mark.parametrize("frame", FRAMES)
def test_frames(flight: MissionHarness, frame: int) -> None:
    wanted = item(CMD.NAV_WAYPOINT, at=(10, 0, 20), frame=frame)
    assert check(flight, wanted) == FRAMES[frame][flight.firmware is PX4]  # type: ignore[index]


def test_what_has_no_place_comes_in_the_frame_mission_to_px4(flight: MissionHarness) -> None:
    wanted = item(CMD.DO_CHANGE_SPEED, 1, 5, frame=FRAME.GLOBAL_RELATIVE_ALT)
    assert check(flight, wanted) == (RESULT.ACCEPTED if flight.firmware is ARDUPILOT else RESULT.UNSUPPORTED)


def test_regions_of_interest_have_modes_in_px4() -> None:
    flight = MissionHarness(firmware=PX4)
    modes = {mode: check(flight, item(CMD.DO_SET_ROI, float(mode))) for mode in common.MavRoi}
    refused = {mode for mode, result in modes.items() if result != RESULT.ACCEPTED}
    assert refused == {common.MavRoi.LOCATION, common.MavRoi.TARGET}


def test_one_bad_item_leaves_the_mission_as_it_was(flight: MissionHarness) -> None:
    flight.load(takeoff(), waypoint(10, 0))
    before = flight.mission.items
    assert flight.upload(PLACED, PLACED, item(60000)) == RESULT.UNSUPPORTED
    assert flight.mission.items == before


def test_the_other_plans_hold_their_own_items_only(flight: MissionHarness) -> None:
    rally = item(CMD.NAV_RALLY_POINT, at=(10, 0, 30))
    assert check(flight, rally, PlanType.RALLY) == RESULT.ACCEPTED
    assert check(flight, rally) == RESULT.UNSUPPORTED
    assert check(flight, PLACED, PlanType.RALLY) == RESULT.UNSUPPORTED
    assert check(flight, PLACED, PlanType.FENCE) == RESULT.UNSUPPORTED
    assert (
        check(flight, item(CMD.NAV_RALLY_POINT, at=(1, 0, 3), frame=1), PlanType.RALLY)
        == RESULT.UNSUPPORTED_FRAME
    )


@pytest.mark.parametrize(
    ("items", "text"),
    [
        ([land()], "Mission rejected: starts with landing"),
        ([waypoint(5, 5), takeoff()], "Mission rejected: takeoff not first waypoint item"),
        ([takeoff(-5)], "Mission rejected: Takeoff altitude below home altitude!"),
    ],
)
def test_px4_accepts_a_plan_that_it_will_not_fly_and_reports_it(items: list[MissionItem], text: str) -> None:
    flight = MissionHarness(firmware=PX4)
    flight.load(*items)
    assert flight.status_texts == [text]
    flight.arm()
    assert flight.mission.start() == "Switching to mode 'Mission' is currently not possible"


def test_ardupilot_reports_that_it_has_a_plan() -> None:
    flight = MissionHarness()
    flight.load(takeoff())
    flight.upload(item(CMD.NAV_RALLY_POINT, at=(10, 0, 30)), kind=PlanType.RALLY)
    circle = item(CMD.NAV_FENCE_CIRCLE_INCLUSION, 50, at=(0, 0, 0))
    flight.upload(circle, kind=PlanType.FENCE)
    assert flight.status_texts == ["Flight plan received", "Rally points received", "Fence received"]
