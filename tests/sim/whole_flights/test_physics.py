"""Speeds, turns and energy are physically possible."""

from __future__ import annotations

from itertools import pairwise
from math import atan2, degrees, dist, hypot, remainder, tan, tau
from typing import TYPE_CHECKING

import pytest

from mavstack.sim.motion.airframes import AIRFRAMES
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.whole_flights.conftest import WINDY_FLIGHTS
from tests.sim.whole_flights.fleet import ALL
from tests.sim.whole_flights.ground_station import SAMPLES
from tests.sim.whole_flights.legs import WINGS

if TYPE_CHECKING:
    from tests.sim.whole_flights.ground_station import Sample

pytestmark = pytest.mark.nightly

#: Maximum ground speed in still air, in m/s: the firmware's parameter plus ten percent; rovers overshoot
#: a little more.
MAX_GROUND_SPEED = {
    VehicleType.COPTER: {Firmware.ARDUPILOT: 10.5, Firmware.PX4: 5.6},
    VehicleType.PLANE: {Firmware.ARDUPILOT: 22.0, Firmware.PX4: 22.0},
    VehicleType.VTOL: {Firmware.ARDUPILOT: 22.0, Firmware.PX4: 22.0},
    VehicleType.ROVER: {Firmware.ARDUPILOT: 5.5, Firmware.PX4: 3.5},
    VehicleType.BOAT: {Firmware.ARDUPILOT: 2.8, Firmware.PX4: 3.3},
    VehicleType.SUB: {Firmware.ARDUPILOT: 1.6, Firmware.PX4: 1.1},
}
#: Maximum climb and descent rate, in m/s.
MAX_VERTICAL_SPEED = {
    VehicleType.COPTER: (3.6, 2.0),
    VehicleType.PLANE: (5.5, 4.5),
    VehicleType.VTOL: (5.0, 2.5),
    VehicleType.ROVER: (0.0, 0.0),
    VehicleType.BOAT: (0.0, 0.0),
    VehicleType.SUB: (1.0, 0.9),
}
#: Maximum bank or lean in degrees, and yaw rate in degrees per second.
MAX_LEAN_AND_YAW_RATE = {
    VehicleType.COPTER: (40, 130),
    VehicleType.PLANE: (55, 60),
    VehicleType.VTOL: (55, 130),
    VehicleType.ROVER: (1, 190),
    VehicleType.BOAT: (1, 100),
    VehicleType.SUB: (5, 60),
}
#: Mean electrical power of a mission, in watts.
MEAN_POWER = {
    VehicleType.COPTER: (140, 260),
    VehicleType.PLANE: (30, 110),
    VehicleType.VTOL: (200, 600),
    VehicleType.ROVER: (15, 60),
    VehicleType.BOAT: (30, 100),
    VehicleType.SUB: (25, 80),
}
GRAVITY = 9.80665


@pytest.fixture(params=[*((0, each) for each in ALL), *((6, each) for each in WINDY_FLIGHTS)], ids=str)
def wind_and_flight(request: pytest.FixtureRequest):
    wind, each = request.param
    return wind, request.getfixturevalue("windy" if wind else "still_air")[each]


def test_ground_speed_is_limited(wind_and_flight) -> None:
    wind, flight = wind_and_flight
    gusts = 1.3 * wind if flight.kind in WINGS else 0.1 * wind
    bound = MAX_GROUND_SPEED[flight.kind][flight.plan.firmware]
    fastest = max(hypot(s.motion.velocity_north, s.motion.velocity_east) for s in flight.flown)
    assert fastest < bound + gusts
    assert fastest > 0.4 * bound


def test_vertical_speed_is_limited(wind_and_flight) -> None:
    wind, flight = wind_and_flight
    climb, sink = (
        bound + (0.1 * wind if flight.kind.flies else 0) for bound in MAX_VERTICAL_SPEED[flight.kind]
    )
    assert max(-sample.motion.velocity_down for sample in flight.flown) <= climb + 1e-6
    assert max(sample.motion.velocity_down for sample in flight.flown) <= sink + 1e-6


def test_lean_and_yaw_rate_are_limited(wind_and_flight) -> None:
    _, flight = wind_and_flight
    lean, turn = MAX_LEAN_AND_YAW_RATE[flight.kind]
    for sample in flight.flown:
        assert degrees(max(abs(sample.motion.roll), abs(sample.motion.pitch))) < lean
        assert degrees(abs(sample.motion.yaw_rate)) < turn


def test_positions_follow_from_velocities(wind_and_flight) -> None:
    """The distance of two samples follows from the speed between them."""
    _, flight = wind_and_flight
    for one, other in pairwise(flight.track):
        elapsed = other.time - one.time
        middle = [(a + b) / 2 * elapsed for a, b in zip(one.motion[3:6], other.motion[3:6], strict=True)]
        moved = [b - a for a, b in zip(one.motion[:3], other.motion[:3], strict=True)]
        assert dist(moved, middle) < 0.15 + 0.6 * elapsed**2 * GRAVITY


def test_velocities_follow_from_accelerations(wind_and_flight) -> None:
    """Accelerations are within the limits of motors, wings and the ground."""
    _, flight = wind_and_flight
    maximum = 2.2 * GRAVITY if flight.kind.flies else 6.0
    for one, other in pairwise(flight.flown):
        if one.on_ground or other.on_ground:
            continue  # a touchdown may be hard
        change = dist(one.motion[3:6], other.motion[3:6])
        assert change * SAMPLES < maximum, one.time


def test_wing_turns_by_its_bank(still_air) -> None:
    """In still air the rate of a steady turn follows from bank and airspeed."""
    turns = 0
    for firmware in Firmware:
        flown = still_air[VehicleType.PLANE, firmware].flown
        for before, one, after in zip(flown, flown[1:], flown[2:], strict=False):
            banks = [each.motion.roll for each in (before, one, after)]
            if min(map(abs, banks)) > 0.2 and max(banks) - min(banks) < 0.04 and not one.on_ground:
                turns += 1
                rate = remainder(course(after) - course(before), tau) * SAMPLES / 2
                assert rate == pytest.approx(GRAVITY * tan(banks[1]) / one.airspeed, rel=0.25, abs=0.05)
    assert turns > 50


def course(sample: Sample) -> float:
    return atan2(sample.motion.velocity_east, sample.motion.velocity_north)


def test_no_wing_stalls(wind_and_flight) -> None:
    wind, flight = wind_and_flight
    if flight.kind in WINGS:
        slowest = AIRFRAMES[flight.kind].airspeed_min - (3.0 if wind else 1.0)
        height = 0.6 * flight.plan.size.height
        flying = [s for s in flight.flown if s.transition > 0.95 and -s.motion.down > height]
        assert flying
        assert min(sample.airspeed for sample in flying) > slowest


def test_battery_charge_only_decreases(wind_and_flight) -> None:
    _, flight = wind_and_flight
    for one, other in pairwise(flight.flown):
        assert other.battery.consumed >= one.battery.consumed
        assert other.battery.remaining <= one.battery.remaining
        assert 0.8 * 3.0 < other.battery.voltage / other.battery.cells < 4.25
        assert other.battery.current > 0


def test_charge_is_the_sum_of_the_current(wind_and_flight) -> None:
    _, flight = wind_and_flight
    flown = flight.flown
    charge = sum(sample.battery.current for sample in flown) / SAMPLES / 3.6
    consumed = flown[-1].battery.consumed - flown[0].battery.consumed
    assert consumed == pytest.approx(charge, rel=0.03)
    share = consumed / flown[0].battery.capacity
    assert flown[0].battery.remaining - flown[-1].battery.remaining == pytest.approx(share, abs=0.01)


def test_mission_energy_is_plausible(wind_and_flight) -> None:
    wind, flight = wind_and_flight
    flown = flight.flown
    power = sum(sample.battery.current * sample.battery.voltage for sample in flown) / len(flown)
    minimum, maximum = MEAN_POWER[flight.kind]
    assert minimum < power < maximum * (1.3 if wind else 1.0)
    # at least the potential energy of a vehicle of one kilogram
    energy = power * len(flown) / SAMPLES
    assert energy > GRAVITY * abs(flight.plan.size.height)


def test_disarmed_vehicle_is_at_rest_with_low_current(wind_and_flight) -> None:
    wind, flight = wind_and_flight
    before = [sample for sample in flight.track if sample.time < flight.began - 1]
    assert before
    for sample in before:
        assert sample.battery.current < 2.0
        if flight.kind is not VehicleType.BOAT or not wind:
            assert dist(sample.motion[:2], (0, 0)) < 1.0
