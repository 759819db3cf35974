"""Tracks stay within bounds of the plan, in still air and in wind."""

from __future__ import annotations

import pytest

from mavstack.sim.vehicle_types import VehicleType
from tests.sim.whole_flights.conftest import WINDY_FLIGHTS
from tests.sim.whole_flights.fleet import ALL
from tests.sim.whole_flights.legs import WINGS, legs_of

pytestmark = pytest.mark.nightly

#: Cross-track error in metres, in still air and in 6 m/s of wind; wings turn in wide circles.
MAX_CROSS_TRACK_ERROR = {
    VehicleType.COPTER: (5.0, 5.0),
    VehicleType.PLANE: (25.0, 60.0),
    VehicleType.VTOL: (40.0, 60.0),
    VehicleType.ROVER: (2.5, 2.5),
    VehicleType.BOAT: (2.5, 4.0),
    VehicleType.SUB: (2.0, 2.0),
}
#: Altitude error on level legs, in metres.
MAX_ALTITUDE_ERROR = {
    VehicleType.COPTER: (1.0, 1.5),
    VehicleType.PLANE: (3.0, 5.0),
    VehicleType.VTOL: (3.0, 5.0),
    VehicleType.ROVER: (0.0, 0.0),
    VehicleType.BOAT: (0.0, 0.0),
    VehicleType.SUB: (0.6, 0.6),
}
#: Error of the radius of a circle, in metres.
MAX_RADIUS_ERROR = {
    VehicleType.COPTER: 1.5,
    VehicleType.PLANE: 6.0,
    VehicleType.VTOL: 8.0,
    VehicleType.ROVER: 1.5,
    VehicleType.BOAT: 2.0,
    VehicleType.SUB: 1.0,
}
#: Additional error of a wing that leaves a circle, in metres.
CIRCLE_EXIT_ERROR = 40.0
#: Number of samples in which an altitude error at the start of a leg is corrected.
SETTLING_SAMPLES = 25


@pytest.fixture(params=[*((0, each) for each in ALL), *((1, each) for each in WINDY_FLIGHTS)], ids=str)
def wind_and_flight(request: pytest.FixtureRequest):
    wind, each = request.param
    return wind, request.getfixturevalue(("still_air", "windy")[wind])[each]


def test_cross_track_error_is_bounded(wind_and_flight) -> None:
    wind, flight = wind_and_flight
    legs = legs_of(flight)
    assert len(legs) >= (2 if wind else 10)
    for leg in legs:
        exit_error = (
            CIRCLE_EXIT_ERROR
            if flight.kind in WINGS and leg.before is not None and leg.before.circle
            else 0.0
        )
        assert leg.max_cross_track_error < MAX_CROSS_TRACK_ERROR[flight.kind][wind] + exit_error, leg.seq


def test_altitude_error_is_bounded(wind_and_flight) -> None:
    wind, flight = wind_and_flight
    bound = MAX_ALTITUDE_ERROR[flight.kind][wind] + 1e-6
    for leg in legs_of(flight):
        if leg.end[2] == flight.plan.size.height and leg.before is not None:
            altitude_errors = leg.altitude_errors()[SETTLING_SAMPLES:]
            assert max(map(abs, altitude_errors), default=0.0) <= bound, leg.seq


def test_circles_are_round(still_air) -> None:
    seen = 0
    for flight in still_air.values():
        for leg in legs_of(flight):
            if leg.circle and len(leg.track) > 50:
                seen += 1
                assert leg.max_radius_error < MAX_RADIUS_ERROR[flight.kind], (
                    flight.kind,
                    flight.plan.firmware,
                )
    assert seen >= 8


def test_wings_stay_above_the_planned_altitude_before_landing(still_air) -> None:
    for flight in still_air.values():
        if flight.kind in WINGS:
            for leg in legs_of(flight):
                assert min(leg.altitude_errors()[SETTLING_SAMPLES:], default=0.0) > -5.0


def test_plane_takes_off_along_its_runway_in_wind(windy) -> None:
    """The plane stands and takes off to the north, in wind from the south-west."""
    flight = next(flight for (kind, _), flight in windy.items() if kind is VehicleType.PLANE)
    low = [sample.motion for sample in flight.flown if sample.motion.north < 40 and sample.motion.down > -5]
    assert max(motion.north for motion in low) > 20
    assert max(abs(motion.east) for motion in low) < 8
