"""Mission items that loiter: without end, for a time, for turns, to an altitude, and delays."""

from __future__ import annotations

from math import atan2, inf, pi, remainder

import pytest

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
COPTER, PLANE = VehicleType.COPTER, VehicleType.PLANE


@pytest.mark.nightly
@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_loitering_without_end(firmware: Firmware) -> None:
    flight = fly_items(item(CMD.NAV_LOITER_UNLIM, at=(15, 0, 10)), waypoint(0, 0, 10), firmware=firmware)
    flight.run(40)
    assert flight.distance((15, 0)) < 2.5
    assert flight.mission.sequence == flight.first + 1


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_loitering_for_a_time(firmware: Firmware) -> None:
    flight = fly_items(item(CMD.NAV_LOITER_TIME, 12, at=(10, 0, 10)), waypoint(0, 0, 10), firmware=firmware)
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


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize(("radius", "direction"), [(12.0, 1), (-12.0, -1)])
def test_turns_of_a_copter(radius: float, direction: int) -> None:
    flight = fly_items(item(CMD.NAV_LOITER_TURNS, 2, 0, radius, at=(0, 0, 10)), waypoint(0, 0, 10))
    flight.run_until(lambda: flight.distance() > 10, timeout=30)
    assert turned(flight, (0, 0), 3) * direction == pytest.approx(2, abs=0.35)


@pytest.mark.nightly
@pytest.mark.flight
def test_turns_of_a_plane() -> None:
    flight = MissionHarness(PLANE)
    flight.load(takeoff(40), item(CMD.NAV_LOITER_TURNS, 2, 0, 80, at=(300, 0, 40)), waypoint(0, 0, 40))
    flight.start()
    flight.reach(2)
    flight.run_until(lambda: abs(flight.distance((300, 0)) - 80) < 15, timeout=60)
    assert turned(flight, (300, 0), 3) == pytest.approx(2, abs=0.4)


@pytest.mark.nightly
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


@pytest.mark.flight_cases(1)
@pytest.mark.flight
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
    flight = fly_items(item(CMD.NAV_DELAY, 8), waypoint(10, 0, 10), firmware=firmware)
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
