"""Circles: the mode, and DO_ORBIT's."""

from __future__ import annotations

from math import atan2, pi

import pytest

from mavstack.dialects import common
from mavstack.sim.autopilot.behaviours import Circle, Orbit
from mavstack.sim.autopilot.radio import Sticks
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.autopilot.harness import GUIDED, AutopilotHarness, turned

YAW = common.OrbitYawBehaviour
CENTRE = (30.0, 0.0, -15.0)


def bearing(flight: AutopilotHarness, centre: tuple[float, float, float] = CENTRE) -> float:
    """From the centre to the vehicle."""
    return atan2(flight.body.truth.east - centre[1], flight.body.truth.north - centre[0])


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("radius", [15.0, -15.0])
def test_a_copter_orbits_in_the_commanded_direction(radius: float) -> None:
    flight = AutopilotHarness().in_the_air(15.0)
    flight.fly(lambda autopilot: Orbit(autopilot, CENTRE, radius, speed=4.0))
    flight.run(25)
    before = bearing(flight)
    for _ in range(5):
        flight.run(1)
        assert flight.distance(CENTRE) == pytest.approx(15.0, abs=2.0)
        assert turned(bearing(flight) - before) * radius > 0
        assert abs(turned(flight.body.truth.yaw - bearing(flight) - pi)) < 0.4, "it looks at the centre"
        before = bearing(flight)
    assert flight.speed == pytest.approx(4.0, abs=0.8)


@pytest.mark.nightly
def test_it_can_look_along_the_circle_or_where_it_looked() -> None:
    flight = AutopilotHarness().in_the_air(15.0)
    flight.fly(
        lambda autopilot: Orbit(
            autopilot, CENTRE, 15.0, speed=3.0, yaw_behaviour=YAW.HOLD_FRONT_TANGENT_TO_CIRCLE
        )
    )
    flight.run(25)
    assert abs(turned(flight.body.truth.yaw - bearing(flight) - pi / 2)) < 0.4
    yaw = flight.body.truth.yaw
    flight.fly(
        lambda autopilot: Orbit(autopilot, CENTRE, 15.0, speed=3.0, yaw_behaviour=YAW.HOLD_INITIAL_HEADING)
    )
    flight.run(10)
    assert abs(turned(flight.body.truth.yaw - yaw)) < 0.3


@pytest.mark.flight
def test_it_stops_after_the_turns_that_were_asked() -> None:
    flight = AutopilotHarness().in_the_air(15.0)
    orbit = Orbit(flight.autopilot, (10.0, 0.0, -15.0), 8.0, speed=4.0, turns=1.5)
    flight.fly(lambda autopilot: orbit)
    flight.run_until(lambda: abs(orbit.turned) >= 1.5, timeout=60)
    flight.run(6)
    assert flight.speed < 0.5


@pytest.mark.flight
def test_the_mode_can_circle_where_it_is() -> None:
    flight = AutopilotHarness(circle_radius=6.0, circle_speed=1.0, circles_where_it_is=True).in_the_air(10.0)
    here = flight.body.truth
    flight.fly(Circle)
    flight.run(40)
    assert flight.distance((here.north, here.east, here.down)) == pytest.approx(6.0, abs=1.0)


@pytest.mark.nightly
@pytest.mark.parametrize("kind", [VehicleType.COPTER, VehicleType.ROVER, VehicleType.BOAT, VehicleType.SUB])
def test_the_mode_circles_a_point_one_radius_ahead(kind: VehicleType) -> None:
    flight = AutopilotHarness(kind, circle_radius=6.0, circle_speed=1.0)
    if kind is VehicleType.COPTER:
        flight.in_the_air(10.0)
    else:
        flight.arm()
    yaw = flight.body.truth.yaw
    assert abs(yaw) < 0.1
    here = flight.body.truth
    centre = here.north + 6.0, here.east, here.down
    flight.fly(Circle)
    flight.run(40)
    seen = set()
    for _ in range(40):
        flight.run(1)
        assert flight.distance(centre) == pytest.approx(6.0, abs=2.0)
        seen.add(round(bearing(flight, centre)))
    assert len(seen) >= 5, "it goes round"


@pytest.mark.nightly
def test_a_plane_circles_where_it_is() -> None:
    flight = AutopilotHarness(VehicleType.PLANE).in_the_air(40.0)
    flight.run(15)
    here = flight.body.truth
    flight.fly(Circle)
    flight.run(40)
    for _ in range(10):
        flight.run(1)
        assert flight.distance(here[:2]) == pytest.approx(60.0, abs=15.0)


@pytest.mark.nightly
def test_a_plane_orbits_with_the_radius_of_the_command() -> None:
    flight = AutopilotHarness(VehicleType.PLANE).in_the_air(40.0)
    flight.enter(GUIDED)
    flight.autopilot.guided.orbit((300.0, 100.0, -50.0), -100.0)
    flight.run(60)
    before = bearing(flight, (300.0, 100.0, -50.0))
    flight.run(2)
    assert turned(bearing(flight, (300.0, 100.0, -50.0)) - before) < 0
    assert flight.distance((300.0, 100.0)) == pytest.approx(100.0, abs=20.0)


@pytest.mark.nightly
def test_a_vtol_circles_hovering_or_on_its_wing() -> None:
    flight = AutopilotHarness(VehicleType.VTOL).in_the_air(40.0)
    flight.fly(lambda autopilot: Circle(autopilot, forward=True))
    flight.run(30)
    assert flight.body.transition == 1.0
    flight.fly(lambda autopilot: Circle(autopilot, forward=False))
    flight.run(40)
    assert flight.body.transition == 0.0
    assert 1.0 < flight.speed < 7.0


@pytest.mark.flight
@pytest.mark.parametrize(("throttle", "rises"), [(0.0, -1), (0.5, 0), (1.0, 1)])
def test_in_the_mode_the_throttle_climbs_and_sinks(throttle: float, rises: int) -> None:
    flight = AutopilotHarness(circle_radius=6.0, circle_speed=1.0).in_the_air(40.0)
    flight.radio.sticks = Sticks(0.0, 0.0, throttle, 0.0)
    flight.fly(Circle)
    flight.run(8)
    climbed = -flight.body.truth.down - 40.0
    assert climbed * rises > 4 if rises else abs(climbed) < 2
