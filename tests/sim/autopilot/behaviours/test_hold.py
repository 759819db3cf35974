"""Staying."""

from __future__ import annotations

import pytest

from mavstack.sim.autopilot.behaviours import Brake, Hold, Stop
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.autopilot.harness import GUIDED, HOLD, LAND, AutopilotHarness


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("behaviour", [Hold, Brake])
def test_a_copter_brakes_and_stays_in_the_wind(behaviour: type[Hold]) -> None:
    flight = AutopilotHarness()
    flight.world.set_wind(speed=5.0, direction=90.0, turbulence=0.2)
    flight.in_the_air(15.0)
    flight.enter(GUIDED)
    flight.autopilot.guided.fly_velocity(7.0, 0.0, 0.0)
    flight.run(2.8)
    assert flight.speed > 4
    flight.fly(behaviour)
    flight.run(8)
    here = flight.body.truth
    assert flight.speed < 1.0
    flight.run(30)
    assert flight.distance(here[:2]) < 2.0
    assert flight.height == pytest.approx(15.0, abs=1.5)


@pytest.mark.fast_cases(3)
@pytest.mark.parametrize("behaviour", [Hold, Brake])
@pytest.mark.parametrize("kind", [VehicleType.COPTER, VehicleType.PLANE, VehicleType.VTOL])
def test_on_the_ground_it_stays_there_until_it_disarms(behaviour: type[Hold], kind: VehicleType) -> None:
    flight = AutopilotHarness(kind)
    flight.arm()
    flight.fly(behaviour)
    flight.run(9)
    assert flight.autopilot.armed
    assert flight.height == 0.0
    assert flight.distance() < 1.0
    flight.run(3)
    assert not flight.autopilot.armed


@pytest.mark.nightly
@pytest.mark.parametrize("kind", [VehicleType.PLANE, VehicleType.VTOL])
def test_a_wing_circles_where_it_is(kind: VehicleType) -> None:
    flight = AutopilotHarness(kind).in_the_air(50.0)
    flight.fly(lambda autopilot: Hold(autopilot, forward=True))
    here = flight.body.truth
    flight.run(40)
    for _ in range(10):
        flight.run(2)
        assert flight.speed > 11
        assert flight.distance(here[:2]) < 250
        assert flight.height == pytest.approx(50.0, abs=6.0)


@pytest.mark.nightly
def test_a_vtol_holds_in_the_mode_of_its_transition() -> None:
    flight = AutopilotHarness(VehicleType.VTOL).in_the_air(40.0)
    flight.enter(HOLD)
    flight.body.transition_to(True)
    flight.run(20)
    assert flight.body.transition == 1.0
    assert flight.height == pytest.approx(40.0, abs=6.0)
    flight.body.transition_to(False)
    flight.run(25)
    assert flight.body.transition == 0.0
    assert flight.speed < 1.0


@pytest.mark.flight
def test_hold_flies_to_a_commanded_position_and_ignores_setpoints() -> None:
    flight = AutopilotHarness().in_the_air(10.0)
    flight.enter(HOLD)
    assert not flight.autopilot.behaviour.takes_setpoints
    flight.autopilot.guided.go_to((12.0, 5.0, -14.0))
    flight.run(12)
    assert flight.distance((12.0, 5.0)) < 1.5
    assert flight.height == pytest.approx(14.0, abs=1.0)


@pytest.mark.flight
def test_another_mode_forgets_where_it_was_to_go() -> None:
    flight = AutopilotHarness().in_the_air(10.0)
    flight.enter(HOLD)
    flight.autopilot.guided.go_to((50.0, 0.0, -10.0))
    flight.autopilot.maneuvers.speed = 2.0
    flight.run(3)
    flight.enter(LAND)
    assert flight.autopilot.maneuvers.speed is None
    flight.enter(HOLD)
    flight.run(20)
    assert flight.distance() < 20


def test_a_rover_that_holds_has_its_motors_at_rest() -> None:
    flight = AutopilotHarness(VehicleType.ROVER)
    flight.arm()
    flight.fly(Stop)
    flight.run(3)
    assert flight.speed < 0.1
    assert flight.autopilot.armed
