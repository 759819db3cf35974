"""Tracks stay within bounds of the plan, in still air and in wind."""

from __future__ import annotations

import pytest

from mavstack.sim.vehicle_types import VehicleType
from tests.sim.whole_flights.conftest import WINDY
from tests.sim.whole_flights.fleet import ALL
from tests.sim.whole_flights.legs import WINGS, legs_of

#: Cross-track error in metres, in still air and in 6 m/s of wind; wings turn in wide circles.
SIDEWAYS = {
    VehicleType.COPTER: (5.0, 5.0),
    VehicleType.PLANE: (25.0, 60.0),
    VehicleType.VTOL: (40.0, 60.0),
    VehicleType.ROVER: (2.5, 2.5),
    VehicleType.BOAT: (2.5, 4.0),
    VehicleType.SUB: (2.0, 2.0),
}
#: Altitude error on level legs, in metres.
HEIGHT = {
    VehicleType.COPTER: (1.0, 1.5),
    VehicleType.PLANE: (3.0, 5.0),
    VehicleType.VTOL: (3.0, 5.0),
    VehicleType.ROVER: (0.0, 0.0),
    VehicleType.BOAT: (0.0, 0.0),
    VehicleType.SUB: (0.6, 0.6),
}
#: Error of the radius of a circle, in metres.
ROUND = {
    VehicleType.COPTER: 1.5,
    VehicleType.PLANE: 6.0,
    VehicleType.VTOL: 8.0,
    VehicleType.ROVER: 1.5,
    VehicleType.BOAT: 2.0,
    VehicleType.SUB: 1.0,
}
#: Additional error of a wing that leaves a circle, in metres.
LEAVING = 40.0
#: Number of samples in which an altitude error at the start of a leg is corrected.
SETTLING = 25


@pytest.fixture(params=[*((0, each) for each in ALL), *((1, each) for each in WINDY)], ids=str)
def weather_and_flight(request: pytest.FixtureRequest):
    weather, each = request.param
    return weather, request.getfixturevalue(("calm", "windy")[weather])[each]


def test_it_keeps_to_its_legs(weather_and_flight) -> None:
    weather, flight = weather_and_flight
    legs = legs_of(flight)
    assert len(legs) >= (2 if weather else 10)
    for leg in legs:
        leaving = LEAVING if flight.kind in WINGS and leg.before is not None and leg.before.circle else 0.0
        assert leg.worst < SIDEWAYS[flight.kind][weather] + leaving, leg.seq


def test_it_keeps_its_height(weather_and_flight) -> None:
    weather, flight = weather_and_flight
    bound = HEIGHT[flight.kind][weather] + 1e-6
    for leg in legs_of(flight):
        if leg.end[2] == flight.plan.size.height and leg.before is not None:
            heights = leg.heights()[SETTLING:]
            assert max(map(abs, heights), default=0.0) <= bound, leg.seq


def test_circles_are_round(calm) -> None:
    seen = 0
    for flight in calm.values():
        for leg in legs_of(flight):
            if leg.circle and len(leg.track) > 50:
                seen += 1
                assert leg.out_of_round < ROUND[flight.kind], (flight.kind, flight.plan.firmware)
    assert seen >= 8


def test_no_wing_comes_lower_than_the_plan_before_it_lands(calm) -> None:
    for flight in calm.values():
        if flight.kind in WINGS:
            for leg in legs_of(flight):
                assert min(leg.heights()[SETTLING:], default=0.0) > -5.0


def test_a_plane_takes_off_along_its_runway_in_wind(windy) -> None:
    """The plane stands and takes off to the north, in wind from the south-west."""
    flight = next(flight for (kind, _), flight in windy.items() if kind is VehicleType.PLANE)
    low = [sample.motion for sample in flight.flown if sample.motion.north < 40 and sample.motion.down > -5]
    assert max(motion.north for motion in low) > 20
    assert max(abs(motion.east) for motion in low) < 8
