"""Items and their two forms on the wire."""

from __future__ import annotations

from math import isnan, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import InvalidTypeError
from mavstack.services.mission import MissionItem, Plan, PlanType
from tests.services.network import VEHICLE

WAYPOINT, JUMP = common.MavCmd.NAV_WAYPOINT, common.MavCmd.DO_JUMP
FRAME = common.MavFrame


@pytest.mark.parametrize(
    ("command", "frame", "scale"),
    [
        (WAYPOINT, FRAME.GLOBAL, 1e7),
        (WAYPOINT, FRAME.GLOBAL_RELATIVE_ALT_INT, 1e7),
        (WAYPOINT, FRAME.GLOBAL_TERRAIN_ALT, 1e7),
        (WAYPOINT, FRAME.LOCAL_NED, 1e4),
        (JUMP, FRAME.MISSION, 1),
        (JUMP, FRAME.GLOBAL, 1),
    ],
)
def test_global_frames_are_times_1e7_and_local_ones_times_1e4(command, frame, scale) -> None:
    item = MissionItem(command, param5=47.0, param6=-8.0, frame=frame)
    message = item.to_int(VEHICLE, 3, PlanType.FENCE)
    assert (message.x, message.y) == (round(47 * scale), round(-8 * scale))
    assert (message.seq, message.mission_type, message.target_system) == (3, PlanType.FENCE, 1)
    assert MissionItem.read(message) == item


def test_old_items_carry_degrees() -> None:
    item = MissionItem(WAYPOINT, param5=47.5, param6=8.25, param7=10.0)
    message = item.to_float(VEHICLE, 0, PlanType.MISSION)
    assert isinstance(message, common.MissionItem)
    assert (message.x, message.y, message.z) == (47.5, 8.25, 10.0)
    assert MissionItem.read(message) == item


def test_unknown_position_is_the_largest_integer() -> None:
    message = MissionItem(WAYPOINT, param4=nan, param5=nan, param6=nan).to_int(VEHICLE, 0, 0)
    assert (message.x, message.y) == (0x7FFFFFFF, 0x7FFFFFFF)
    item = MissionItem.read(message)
    assert isnan(item.param5)
    assert isnan(item.param4)
    assert item == MissionItem(WAYPOINT, param4=nan, param5=nan, param6=nan)


def test_equality_is_that_of_the_wire() -> None:
    item = MissionItem(WAYPOINT, param1=0.1, param5=47.00000001, frame=FRAME.GLOBAL_INT)
    assert item == MissionItem(WAYPOINT, param1=0.1 + 1e-12, param5=47.0, frame=FRAME.GLOBAL)
    assert hash(item) == hash(MissionItem(WAYPOINT, param1=0.1, param5=47.0, frame=FRAME.GLOBAL))
    assert item != MissionItem(WAYPOINT, param1=0.2, param5=47.0, frame=FRAME.GLOBAL)
    assert MissionItem(WAYPOINT, current=True) == MissionItem(WAYPOINT)
    assert MissionItem(WAYPOINT, autocontinue=False) != MissionItem(WAYPOINT)
    assert MissionItem(WAYPOINT) != "waypoint"


def test_a_frame_without_a_location_means_nothing() -> None:
    """ArduPilot returns GLOBAL for every command without a location."""
    sent = MissionItem(common.MavCmd.NAV_RETURN_TO_LAUNCH)
    held = MissionItem(common.MavCmd.NAV_RETURN_TO_LAUNCH, frame=FRAME.GLOBAL)
    assert (sent.frame, sent) == (FRAME.MISSION, held)
    assert hash(sent) == hash(held)
    assert MissionItem(WAYPOINT, frame=FRAME.GLOBAL) != MissionItem(WAYPOINT, frame=FRAME.GLOBAL_TERRAIN_ALT)


def test_names() -> None:
    assert MissionItem(WAYPOINT).name == "NAV_WAYPOINT"
    assert MissionItem(64999).name == "MAV_CMD 64999"


def test_checksum_is_of_the_items_and_the_type() -> None:
    one, two = MissionItem(WAYPOINT, param7=1), MissionItem(WAYPOINT, param7=2)
    sums = {Plan.of(items).checksum() for items in ([one, two], [two, one], [one], [two])}
    sums.add(Plan.of([one, two], PlanType.FENCE).checksum())
    assert len(sums) == 5
    assert 0 not in sums
    assert Plan.of([]).checksum() == 0
    assert Plan.of([one]).with_id(7) == Plan.of([one])
    assert Plan.of([one]).with_id(7).plan_id == 7


FLOATS = st.floats(allow_nan=True, allow_infinity=True)


@given(st.integers(0, 65535), st.integers(0, 255), st.lists(FLOATS, min_size=7, max_size=7), st.booleans())
def test_any_item_goes_over_the_wire_and_back(command, frame, params, autocontinue) -> None:
    item = MissionItem(command, *params, frame=frame, autocontinue=autocontinue)
    again = MissionItem.read(item.to_int(VEHICLE, 0, 0))
    assert again == item
    assert MissionItem.read(again.to_int(VEHICLE, 0, 0)) == again
    item.to_float(VEHICLE, 0, 0)


FRAMES = [
    (MissionItem(common.MavCmd.NAV_WAYPOINT), FRAME.GLOBAL_RELATIVE_ALT),
    (MissionItem(common.MavCmd.NAV_TAKEOFF, param7=10), FRAME.GLOBAL_RELATIVE_ALT),
    (MissionItem(common.MavCmd.NAV_RETURN_TO_LAUNCH), FRAME.MISSION),
    (MissionItem(common.MavCmd.NAV_DELAY, 5), FRAME.MISSION),
    (MissionItem(common.MavCmd.DO_CHANGE_SPEED, 1, 5), FRAME.MISSION),
    (MissionItem(common.MavCmd.DO_JUMP, 1, 2), FRAME.MISSION),
    (MissionItem(common.MavCmd.DO_LAND_START), FRAME.MISSION),
    (MissionItem(common.MavCmd.DO_LAND_START, param5=47.0, param6=8.0), FRAME.GLOBAL_RELATIVE_ALT),
    (MissionItem(common.MavCmd.DO_SET_ROI_LOCATION, param5=47.0), FRAME.GLOBAL_RELATIVE_ALT),
    (MissionItem(common.MavCmd.DO_SET_ROI_NONE), FRAME.MISSION),
    (MissionItem(common.MavCmd.NAV_FENCE_CIRCLE_INCLUSION, 50, param5=47.0), FRAME.GLOBAL_RELATIVE_ALT),
    (MissionItem(60_000, param5=47.0, param6=8.0), FRAME.GLOBAL_RELATIVE_ALT),
    (MissionItem(60_000, 1), FRAME.MISSION),
    (MissionItem(common.MavCmd.NAV_RETURN_TO_LAUNCH, frame=FRAME.GLOBAL), FRAME.GLOBAL),
]


@pytest.mark.parametrize(("item", "frame"), FRAMES)
def test_the_default_frame_suits_the_command(item, frame) -> None:
    assert item.frame == frame
    assert type(item)(item.command, param5=1.0, frame=item.frame).frame == frame


def test_named_constructors() -> None:
    item = MissionItem.waypoint(47.0, 8.0, 30, hold=5, radius=2, yaw=90)
    wanted = MissionItem(common.MavCmd.NAV_WAYPOINT, 5, 2, 0, 90, 47.0, 8.0, 30)
    assert item == wanted
    made = [
        (MissionItem.takeoff(10), "NAV_TAKEOFF", FRAME.GLOBAL_RELATIVE_ALT),
        (MissionItem.land(47.0, 8.0), "NAV_LAND", FRAME.GLOBAL_RELATIVE_ALT),
        (MissionItem.return_to_launch(), "NAV_RETURN_TO_LAUNCH", FRAME.MISSION),
        (MissionItem.change_speed(7), "DO_CHANGE_SPEED", FRAME.MISSION),
        (MissionItem.delay(3), "NAV_DELAY", FRAME.MISSION),
        (MissionItem.region_of_interest(47.0, 8.0, 5), "DO_SET_ROI_LOCATION", FRAME.GLOBAL_RELATIVE_ALT),
        (MissionItem.no_region_of_interest(), "DO_SET_ROI_NONE", FRAME.MISSION),
        (MissionItem.home(), "NAV_WAYPOINT", FRAME.GLOBAL_RELATIVE_ALT),
    ]
    for item, name, frame in made:
        assert (item.name, item.frame) == (name, frame)
    assert (MissionItem.change_speed(7).param1, MissionItem.change_speed(7).param2) == (1, 7)
    with pytest.raises(InvalidTypeError, match="param7 must be a number"):
        MissionItem.takeoff("ten")


def test_the_location_of_an_item() -> None:
    assert MissionItem.waypoint(47.0, 8.0, 30).location == (47.0, 8.0)
    for item in (MissionItem.takeoff(10), MissionItem.return_to_launch(), MissionItem.change_speed(5)):
        assert item.location is None
