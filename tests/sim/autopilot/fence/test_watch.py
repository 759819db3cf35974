"""Fence breaches: detection and the actions at a fence."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, PlanType
from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.fence.ardupilot import names_of
from mavstack.sim.autopilot.fence_limits import Breach
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.autopilot.harness import GUIDED, HOLD, LAND, OTHER, RETURN, TAKEOFF
from tests.sim.autopilot.mission.harness import CMD, FRAME, MissionHarness, item

if TYPE_CHECKING:
    from collections.abc import Iterator

ARDUPILOT, PX4 = Firmware.ARDUPILOT, Firmware.PX4
KINDS = common.FenceBreach


class Away(Behaviour):
    """Fly north at 5 m/s, whatever comes."""

    def fly(self) -> Iterator[None]:
        while True:
            self.autopilot.body.fly_velocity(5.0, 0.0, 0.0)
            yield


class Up(Behaviour):
    """Climb."""

    def fly(self) -> Iterator[None]:
        while True:
            self.autopilot.body.fly_velocity(0.0, 0.0, -2.0)
            yield


def square(
    half: float, command: int = CMD.NAV_FENCE_POLYGON_VERTEX_INCLUSION, north: float = 0
) -> list[MissionItem]:
    corners = [(north - half, -half), (north - half, half), (north + half, half), (north + half, -half)]
    return [item(command, 4, at=(*corner, 0.0), frame=FRAME.GLOBAL) for corner in corners]


def circle(radius: float, command: int = CMD.NAV_FENCE_CIRCLE_INCLUSION, north: float = 0.0) -> MissionItem:
    return item(command, radius, at=(north, 0.0, 0.0), frame=FRAME.GLOBAL)


def fenced(
    *items: MissionItem,
    firmware: Firmware = ARDUPILOT,
    kind: VehicleType = VehicleType.COPTER,
    height: float = 20.0,
    **parameters: float,
) -> MissionHarness:
    """In the air within a fence."""
    flight = MissionHarness(kind, firmware)
    usual = {
        "FENCE_ENABLE": 1,
        "FENCE_TYPE": 7,
        "FENCE_ACTION": 1,
        "FENCE_RADIUS": 1000,
        "FENCE_ALT_MAX": 500,
    }
    flight.vehicle.parameters |= (usual if firmware is ARDUPILOT else {"GF_ACTION": 2}) | parameters
    assert flight.upload(*items, kind=PlanType.FENCE) == 0
    if kind.flies:
        flight.in_the_air(height)
    else:
        flight.arm()
    flight.status_texts.clear()
    return flight


def breach(flight: MissionHarness, behaviour: type[Behaviour] = Away, timeout: float = 60.0) -> None:
    flight.fly(behaviour)
    flight.run_until(lambda: flight.autopilot.fence.breaches != Breach.NONE, timeout=timeout)
    flight.run(0.3)


# Detection


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize(
    ("items", "north"),
    [
        (square(40), 40),
        ([circle(40)], 40),
        (square(10, CMD.NAV_FENCE_POLYGON_VERTEX_EXCLUSION, 50), 40),
        ([circle(10, CMD.NAV_FENCE_CIRCLE_EXCLUSION, 50)], 40),
    ],
)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_shapes(items: list[MissionItem], north: float, firmware: Firmware) -> None:
    flight = fenced(*items, firmware=firmware)
    breach(flight)
    assert flight.autopilot.fence.breaches == Breach.SHAPES
    assert north - 1 < flight.body.truth.north < north + 4
    assert flight.autopilot.fence.status().breach_type == KINDS.BOUNDARY


@pytest.mark.flight
def test_the_radius_and_the_altitudes_of_parameters() -> None:
    flight = fenced(FENCE_RADIUS=40, FENCE_ALT_MAX=30)
    breach(flight)
    assert flight.autopilot.fence.breaches == Breach.RADIUS
    assert flight.autopilot.fence.status().breach_type == KINDS.BOUNDARY
    flight = fenced(FENCE_RADIUS=40, FENCE_ALT_MAX=30)
    breach(flight, Up)
    assert flight.autopilot.fence.breaches == Breach.HIGH
    assert flight.autopilot.fence.status().breach_type == KINDS.MAXALT
    assert 29 < flight.height < 33


@pytest.mark.flight
def test_the_lowest_altitude_counts_in_the_air_only() -> None:
    flight = MissionHarness()
    flight.vehicle.parameters |= {"FENCE_ENABLE": 1, "FENCE_TYPE": 8, "FENCE_ALT_MIN": 10, "FENCE_ACTION": 0}
    flight.run(0.5)
    assert not list(flight.autopilot.fence.problems())
    flight.in_the_air(20)
    flight.run(1)
    assert not flight.autopilot.fence.breaches
    flight.enter(LAND)
    flight.run_until(lambda: flight.autopilot.fence.breaches == Breach.LOW, timeout=20)
    assert flight.autopilot.fence.status().breach_type == KINDS.MINALT
    assert flight.autopilot.fence.switch(2)
    flight.run(0.3)
    assert not flight.autopilot.fence.breaches


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(
    ("bits", "found"), [(1, Breach.NONE), (2, Breach.RADIUS), (4, Breach.SHAPES), (6, Breach(6))]
)
def test_fence_type_selects_the_checked_limits(bits: int, found: Breach) -> None:
    flight = fenced(*square(30), FENCE_RADIUS=30, FENCE_TYPE=bits, FENCE_ACTION=0)
    flight.fly(Away)
    flight.run(12)
    assert flight.autopilot.fence.breaches == found


@pytest.mark.flight
def test_a_fence_that_is_off() -> None:
    flight = fenced(*square(30), FENCE_ENABLE=0)
    flight.fly(Away)
    flight.run(12)
    assert flight.autopilot.mode.number == OTHER
    assert flight.autopilot.fence.switch(1)
    flight.run(0.3)
    assert flight.autopilot.mode.number == RETURN
    assert not flight.autopilot.fence.switch(7)


@pytest.mark.flight
def test_switching_off_ends_a_breach() -> None:
    flight = fenced(*square(30), FENCE_ACTION=0)
    breach(flight)
    assert "fence" in flight.autopilot.failsafes
    flight.autopilot.fence.switch(0)
    assert not flight.autopilot.failsafes
    assert flight.autopilot.fence.status().breach_status == 0
    flight.vehicle.parameters["FENCE_ENABLE"] = 0
    assert not flight.autopilot.fence.enabled
    flight.vehicle.parameters["FENCE_ENABLE"] = 1
    assert flight.autopilot.fence.enabled


@pytest.mark.nightly
@pytest.mark.flight
def test_px4s_distances() -> None:
    flight = fenced(firmware=PX4, GF_MAX_HOR_DIST=40, GF_MAX_VER_DIST=40)
    breach(flight)
    assert flight.status_texts == ["Geofence: exceeding maximum distance to Home"]
    flight = fenced(firmware=PX4, GF_MAX_HOR_DIST=40, GF_MAX_VER_DIST=40)
    breach(flight, Up)
    assert flight.status_texts == ["Geofence: exceeding maximum altitude above Home"]


# Actions


@pytest.mark.fast_cases(3)
@pytest.mark.parametrize(
    ("action", "mode"), [(0, OTHER), (1, RETURN), (2, LAND), (3, RETURN), (4, LAND), (5, LAND)]
)
def test_ardupilots_copter(action: int, mode: int) -> None:
    flight = fenced(*square(30), FENCE_ACTION=action)
    breach(flight)
    assert flight.status_texts == ["Polygon fence breached"]
    assert flight.autopilot.mode.number == mode
    assert flight.autopilot.system_status == common.MavState.CRITICAL


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize(("action", "mode"), [(0, OTHER), (1, RETURN), (2, HOLD), (3, RETURN), (4, HOLD)])
def test_ardupilots_rover(action: int, mode: int) -> None:
    flight = fenced(*square(20), kind=VehicleType.ROVER, FENCE_ACTION=action)
    breach(flight)
    assert flight.status_texts == ["Polygon fence breached"]
    assert flight.autopilot.mode.number == mode


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize(("action", "mode"), [(0, OTHER), (1, RETURN), (2, OTHER), (6, GUIDED), (8, RETURN)])
def test_ardupilots_plane(action: int, mode: int) -> None:
    flight = fenced(*square(300), kind=VehicleType.PLANE, height=60, FENCE_ACTION=action)
    flight.body.place(250.0, 0.0, -60.0, 0.0)
    breach(flight)
    assert flight.autopilot.mode.number == mode


@pytest.mark.flight_cases(1)
@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(
    ("action", "mode", "armed"),
    [(1, OTHER, True), (2, HOLD, True), (3, RETURN, True), (4, OTHER, False), (5, LAND, True)],
)
def test_px4(action: int, mode: int, armed: bool) -> None:
    flight = fenced(*square(30), firmware=PX4, GF_ACTION=action)
    breach(flight)
    assert flight.status_texts == ["Geofence: approaching or outside geofence"]
    assert flight.autopilot.mode.number == mode
    assert flight.autopilot.armed == armed
    assert flight.autopilot.terminated == (not armed)


@pytest.mark.flight
def test_px4_without_an_action_does_not_look() -> None:
    flight = fenced(*square(30), firmware=PX4, GF_ACTION=0)
    flight.fly(Away)
    flight.run(12)
    assert not flight.status_texts
    assert not flight.autopilot.fence.breaches


@pytest.mark.flight
def test_a_breach_is_reported_when_it_begins_and_when_it_ends() -> None:
    flight = fenced(*square(30))
    breach(flight)
    flight.run_until(lambda: not flight.autopilot.fence.breaches, timeout=60)
    flight.run(0.3)
    assert flight.status_texts == ["Polygon fence breached", "Fence breach cleared"]
    assert not flight.autopilot.failsafes
    status = flight.autopilot.fence.status()
    assert (status.breach_status, status.breach_count, status.breach_type) == (0, 1, KINDS.NONE)
    assert status.breach_time > 0


@pytest.mark.flight
def test_going_on_outwards_is_another_breach() -> None:
    flight = fenced(*square(30), FENCE_ACTION=0)
    breach(flight)
    flight.run(10)
    assert flight.status_texts == ["Polygon fence breached"] * 3
    assert flight.autopilot.fence.count == 3


@pytest.mark.flight
def test_a_copter_that_is_far_beyond_lands() -> None:
    flight = fenced(*square(30))
    flight.body.place(180.0, 0.0, -20.0, 0.0)
    flight.run(1.0)
    assert flight.autopilot.mode.number == LAND


def test_two_breaches_at_once_are_reported_together() -> None:
    assert names_of(Breach.SHAPES) == "Polygon fence"
    assert names_of(Breach.HIGH | Breach.RADIUS) == "Max Alt and Circle fences"
    assert names_of(Breach(15)) == "Max Alt, Circle, Polygon and Min Alt fences"


# A plane's way back


def return_of(flight: MissionHarness) -> tuple[float, float, float]:
    breach(flight)
    flight.run(0.3)
    target = flight.autopilot.target
    assert target is not None
    return target


def plane(*items: MissionItem, **parameters: float) -> MissionHarness:
    flight = fenced(*items, kind=VehicleType.PLANE, height=60, FENCE_ACTION=6, FENCE_ALT_MIN=20, **parameters)
    flight.body.place(250.0, 0.0, -60.0, 0.0)
    return flight


@pytest.mark.nightly
def test_to_the_return_point() -> None:
    point = item(CMD.NAV_FENCE_RETURN_POINT, at=(50.0, 60.0, 0.0), frame=FRAME.GLOBAL)
    flight = plane(*square(300), point, FENCE_RET_ALT=70)
    assert return_of(flight) == pytest.approx((50, 60, -70), abs=1.5)
    flight.run_until(lambda: flight.distance((50, 60)) < 100, timeout=60)


@pytest.mark.nightly
@pytest.mark.flight
def test_to_the_middle() -> None:
    assert return_of(plane(*square(300, north=20), FENCE_ALT_MAX=100)) == pytest.approx((20, 0, -60), abs=1.5)


@pytest.mark.flight
def test_to_a_rally_point() -> None:
    flight = plane(*square(300), FENCE_RET_RALLY=1)
    flight.upload(item(CMD.NAV_RALLY_POINT, at=(100.0, 100.0, 80.0)), kind=PlanType.RALLY)
    assert return_of(flight) == pytest.approx((100, 100, -80), abs=1.5)


@pytest.mark.nightly
def test_home_without_either() -> None:
    flight = plane(FENCE_RADIUS=300, FENCE_ALT_MAX=100)
    assert return_of(flight)[:2] == pytest.approx((0, 0), abs=2)


# Before the flight


def test_ardupilot_is_not_armed_outside() -> None:
    flight = MissionHarness()
    flight.vehicle.parameters |= {
        "FENCE_ENABLE": 1,
        "FENCE_TYPE": 7,
        "FENCE_RADIUS": 100,
        "FENCE_ALT_MAX": 100,
    }
    flight.upload(*square(20, north=200), kind=PlanType.FENCE)
    flight.run(0.3)
    assert list(flight.autopilot.fence.problems()) == ["Vehicle breaching Polygon fence"]
    assert not flight.status_texts[1:]
    flight.vehicle.parameters |= {"FENCE_RADIUS": -1, "FENCE_ALT_MAX": -1}
    assert list(flight.autopilot.fence.problems())[-2:] == [
        "Invalid FENCE_RADIUS value",
        "Invalid FENCE_ALT_MAX value",
    ]
    flight.vehicle.parameters["FENCE_ENABLE"] = 0
    assert not list(flight.autopilot.fence.problems())


def test_px4_is_not_armed_outside() -> None:
    flight = MissionHarness(firmware=PX4)
    flight.vehicle.parameters["GF_ACTION"] = 2
    flight.upload(*square(20, north=200), kind=PlanType.FENCE)
    flight.run(0.3)
    assert list(flight.autopilot.fence.problems()) == ["Geofence: approaching or outside geofence"]
    assert flight.status_texts == ["Geofence invalid, doesn't contain Home position"]


@pytest.mark.flight
def test_another_fence_counts_at_once() -> None:
    flight = fenced(*square(30))
    breach(flight)
    flight.upload(*square(500), kind=PlanType.FENCE)
    flight.run(0.3)
    assert not flight.autopilot.fence.breaches
    flight.upload(kind=PlanType.FENCE)
    flight.run(0.3)
    assert not flight.autopilot.fence.fence.shapes


@pytest.mark.flight
def test_without_a_position_nothing_is_known() -> None:
    flight = fenced(*square(30))
    flight.body.fail_gps(True)
    flight.run(20)
    assert not flight.autopilot.has_position
    flight.body.place(100.0, 0.0, -20.0, pi)
    flight.run(1)
    assert flight.autopilot.mode.number == TAKEOFF
