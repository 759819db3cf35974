"""Items that act immediately: speeds, home, regions of interest and the fence."""

from __future__ import annotations

from math import atan2, degrees, hypot, pi, remainder
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware
from tests.sim.autopilot.mission.harness import (
    CMD,
    FRAME,
    fly_items,
    fly_short_mission,
    item,
    waypoint,
)

if TYPE_CHECKING:
    from mavstack.services.mission import MissionItem

ARDUPILOT, PX4 = Firmware.ARDUPILOT, Firmware.PX4


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_another_speed(firmware: Firmware) -> None:
    flight = fly_items(item(CMD.DO_CHANGE_SPEED, 1, 3, -1), waypoint(60, 0, 10), firmware=firmware)
    flight.run(8)
    assert flight.speed == pytest.approx(3, abs=0.4)
    flight.ended()
    assert flight.mission.flying or flight.autopilot.maneuvers.speed is None


@pytest.mark.flight
def test_speeds_up_and_down_and_the_usual_ones_again() -> None:
    flight = fly_items(
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
    flight = fly_short_mission(
        item(CMD.DO_SET_HOME, 0, at=(100, 50, DEFAULT_HOME.altitude - 1), frame=FRAME.GLOBAL)
    )
    north, east, down = flight.autopilot.home_position
    assert (north, east) == pytest.approx((100, 50), abs=0.5)
    assert down == pytest.approx(1, abs=0.1)


@pytest.mark.flight
def test_home_here() -> None:
    flight = fly_items(waypoint(20, 0, 10), item(CMD.DO_SET_HOME, 1), waypoint(0, 0, 10))
    flight.reach(4)
    assert flight.autopilot.home_position[0] == pytest.approx(20, abs=3)


@pytest.mark.flight
def test_a_region_of_interest() -> None:
    flight = fly_items(
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
    flight = fly_short_mission(region, firmware=ARDUPILOT)
    found = flight.autopilot.payload.region_of_interest
    assert found is not None
    assert found[:2] == pytest.approx(expected, abs=0.2)


@pytest.mark.flight
def test_the_fence_is_switched() -> None:
    flight = fly_short_mission(item(CMD.DO_FENCE_ENABLE, 1))
    assert flight.autopilot.fence.switched is True
    assert flight.autopilot.fence.enabled
    assert not fly_short_mission(item(CMD.DO_FENCE_ENABLE, 0)).autopilot.fence.enabled
