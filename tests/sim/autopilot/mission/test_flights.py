"""Whole missions of every type and firmware, and how near to their lines they are flown."""

from __future__ import annotations

from itertools import pairwise
from math import hypot
from typing import TYPE_CHECKING

import pytest

from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.autopilot.harness import HOLD, MISSION, RETURN
from tests.sim.autopilot.mission.harness import (
    CMD,
    STATE,
    MissionHarness,
    cross_track,
    item,
    takeoff,
    waypoint,
)

if TYPE_CHECKING:
    from mavstack.services.mission import MissionItem

_T = VehicleType
WINGS = (_T.PLANE, _T.VTOL)
#: Metres: how far the corners are apart, how high, how near to a corner the track does not count, how near
#: the rest is to its line.
SHAPES = {
    _T.COPTER: (60.0, 20.0, 8.0, 5.0),
    _T.PLANE: (500.0, 60.0, 150.0, 25.0),
    _T.VTOL: (500.0, 60.0, 150.0, 25.0),
    _T.ROVER: (40.0, 0.0, 8.0, 2.0),
    _T.BOAT: (30.0, 0.0, 8.0, 3.0),
    _T.SUB: (12.0, -6.0, 3.0, 2.0),
}


def plan(kind: VehicleType, corners: list[tuple[float, float]], up: float) -> list[MissionItem]:
    items = [waypoint(north, east, up) for north, east in corners]
    if kind is _T.VTOL:
        return [takeoff(up, CMD.NAV_VTOL_TAKEOFF), *items, item(CMD.NAV_VTOL_LAND, at=(0.0, 0.0, 0.0))]
    if kind.flies:
        return [takeoff(up), *items, item(CMD.NAV_LAND, at=(0.0, 0.0, 0.0))]
    return items


@pytest.mark.flight
@pytest.mark.flight_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
@pytest.mark.parametrize("kind", list(_T))
def test_a_square(kind: VehicleType, firmware: Firmware) -> None:
    side, up, corner, bound = SHAPES[kind]
    corners = [(side, 0.0), (side, side), (0.0, side)]
    radius = {"acceptance_radius": 50.0} if kind is _T.VTOL else {}
    flight = MissionHarness(kind, firmware, **radius)
    flight.load(*plan(kind, corners, up))
    flight.start()
    legs: dict[int, list[tuple[float, float]]] = {}
    begun = flight.now
    flight.run(0.2)
    while flight.mission.state == STATE.ACTIVE:
        assert flight.now - begun < 450, flight
        flight.run(0.2)
        legs.setdefault(flight.mission.sequence, []).append(flight.place)

    count = len(flight.mission.items)
    assert flight.currents[-count + flight.first :] == list(range(flight.first, count))
    stays_landed = kind is _T.PLANE and firmware is Firmware.ARDUPILOT
    assert flight.reached == list(range(flight.first, count - stays_landed))
    begin = flight.first + (1 if kind.flies else 0)
    for number, (before, after) in enumerate(pairwise(corners), begin + 1):
        assert cross_track(legs[number], before, after, corner) < bound, f"leg to item {number}"
    if kind.flies:
        assert abs(flight.height) < 0.3
        assert flight.distance() < (150.0 if kind is _T.PLANE else 5.0)


@pytest.mark.flight
def test_a_copter_holds_its_altitude_on_its_way() -> None:
    flight = MissionHarness()
    flight.load(takeoff(20), waypoint(80, 0, 20), waypoint(80, 60, 35))
    flight.start()
    flight.reach(2)
    heights = []
    while flight.mission.sequence == 2:
        flight.run(0.2)
        heights.append(flight.height)
    assert all(18.5 < height < 21.5 for height in heights)
    flight.ended()
    flight.run(3)
    assert flight.height == pytest.approx(35, abs=1.5)


# How missions begin


@pytest.mark.flight
def test_ardupilots_copter_must_begin_with_a_takeoff_on_the_ground() -> None:
    flight = MissionHarness()
    flight.load(waypoint(30, 0))
    flight.arm()
    assert flight.mission.start() == "Auto: Missing Takeoff Cmd"
    flight.load(item(CMD.NAV_DELAY, 1), takeoff(), waypoint(30, 0))
    assert flight.mission.start() is None
    flight.reach(3)


@pytest.mark.flight
def test_px4s_copter_takes_off_by_itself() -> None:
    flight = MissionHarness(firmware=Firmware.PX4)
    flight.load(waypoint(30, 0, 15))
    flight.start()
    flight.run_until(lambda: flight.height > 9, timeout=20)
    assert flight.distance() < 3
    flight.ended()
    assert flight.distance((30, 0)) < 5


def test_arming_begins_the_mission_in_its_mode() -> None:
    flight = MissionHarness(firmware=Firmware.PX4)
    flight.load(takeoff(10))
    assert flight.mission.start() is None
    assert not flight.status_texts
    flight.arm()
    flight.run_until(lambda: flight.height > 9, timeout=20)
    assert flight.status_texts[0] == "Executing Mission"


@pytest.mark.parametrize(
    ("kind", "firmware", "text"),
    [
        (_T.COPTER, Firmware.ARDUPILOT, "Mode change to AUTO failed: init failed"),
        (_T.ROVER, Firmware.ARDUPILOT, "No Mission. Can't set AUTO."),
        (_T.COPTER, Firmware.PX4, "Switching to mode 'Mission' is currently not possible"),
    ],
)
def test_no_mission(kind: VehicleType, firmware: Firmware, text: str) -> None:
    flight = MissionHarness(kind, firmware)
    flight.arm()
    assert flight.mission.start() == text
    assert flight.mission.state == STATE.NO_MISSION


@pytest.mark.flight
def test_a_part_of_a_mission() -> None:
    flight = MissionHarness(firmware=Firmware.PX4)
    flight.load(takeoff(10), waypoint(20, 0, 10), waypoint(20, 20, 10), waypoint(0, 20, 10))
    flight.arm()
    assert flight.mission.start(1, 2) is None
    flight.ended()
    assert flight.reached == [1, 2]
    assert flight.distance((20, 20)) < 5
    assert flight.mission.start(3, 1) is not None
    assert flight.mission.start(9) is not None


# How missions end


@pytest.mark.flight
def test_ardupilots_copter_stays_at_its_last_waypoint() -> None:
    flight = MissionHarness()
    flight.load(takeoff(10), waypoint(30, 0, 10))
    flight.start()
    flight.ended()
    flight.run(20)
    assert flight.distance((30, 0)) < 3
    assert flight.mission.flying
    assert flight.mission.server.current_message().mission_mode == 1


@pytest.mark.flight
def test_ardupilots_copter_is_disarmed_when_its_mission_ends_on_the_ground() -> None:
    flight = MissionHarness()
    flight.load(takeoff(8), item(CMD.NAV_LAND))
    flight.start()
    flight.run_until(lambda: not flight.autopilot.armed, timeout=90)
    assert flight.reached == [1, 2]


@pytest.mark.flight
def test_ardupilots_plane_returns() -> None:
    flight = MissionHarness(_T.PLANE)
    flight.load(takeoff(40), waypoint(300, 0, 40))
    flight.start()
    flight.run_until(lambda: flight.autopilot.mode.number == RETURN, timeout=120)
    assert flight.status_texts[-1] == "Mission complete, changing mode to RTL"
    assert flight.mission.state == STATE.COMPLETE


@pytest.mark.nightly
@pytest.mark.parametrize(("kind", "reached"), [(_T.PLANE, [1]), (_T.VTOL, [1, 2])])
def test_ardupilots_wings_are_disarmed_where_they_landed(kind: VehicleType, reached: list[int]) -> None:
    flight = MissionHarness(kind, land_disarm_delay=3.0)
    flight.load(takeoff(30), item(CMD.NAV_LAND, at=(300.0, 0.0, 0.0)))
    flight.start()
    flight.run_until(lambda: not flight.autopilot.armed, timeout=150)
    assert flight.autopilot.mode.number == MISSION
    assert flight.reached == reached
    assert abs(flight.height) < 0.3


@pytest.mark.flight
def test_a_rover_stops() -> None:
    flight = MissionHarness(_T.ROVER)
    flight.load(waypoint(20, 0, 0))
    flight.start()
    flight.ended()
    flight.run(10)
    assert flight.speed < 0.2
    assert flight.status_texts[-1] == "Mission Complete"


@pytest.mark.flight
def test_px4_stays_in_its_mission_and_disarms_after_a_landing() -> None:
    flight = MissionHarness(firmware=Firmware.PX4, land_disarm_delay=2.0, disarm_delay=60.0)
    flight.load(takeoff(8), item(CMD.NAV_LAND))
    flight.start()
    flight.run_until(lambda: flight.status_texts[-1:] == ["Mission finished, landed"], timeout=90)
    assert flight.autopilot.mode.number == MISSION
    assert flight.autopilot.armed
    flight.run(4)
    assert not flight.autopilot.armed


@pytest.mark.flight
def test_px4_holds_where_its_mission_ends_in_the_air() -> None:
    flight = MissionHarness(firmware=Firmware.PX4)
    flight.load(takeoff(8), waypoint(20, 0, 8))
    flight.start()
    flight.run_until(lambda: flight.autopilot.mode.number == HOLD, timeout=90)
    assert flight.status_texts[-1] == "Mission finished, loitering"
    flight.run(8)
    assert flight.distance((20, 0)) < 4


@pytest.mark.flight
def test_a_complete_mission_begins_anew() -> None:
    flight = MissionHarness(firmware=Firmware.PX4)
    flight.load(takeoff(8), waypoint(20, 0, 8), waypoint(0, 0, 8))
    flight.start()
    flight.ended()
    flight.run(1)
    assert flight.mission.start() is None
    flight.run(0.3)
    assert flight.mission.sequence in (0, 1)
    flight.ended()
    assert flight.reached == [0, 1, 2, 0, 1, 2]


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(("restart", "expected"), [(0, 3), (1, 2)])
def test_mis_restart_selects_whether_a_mission_resumes(restart: int, expected: int) -> None:
    flight = MissionHarness()
    flight.vehicle.parameters["MIS_RESTART"] = restart
    flight.load(takeoff(8), waypoint(20, 0, 8), waypoint(60, 0, 8))
    flight.start()
    flight.reach(3)
    flight.run(1)
    flight.enter(HOLD)
    flight.run(2)
    assert flight.mission.state == STATE.PAUSED
    assert flight.mission.server.current_message().mission_mode == 2
    flight.start()
    flight.run(0.2)
    assert flight.mission.sequence == expected
    assert hypot(*flight.place) > 15
