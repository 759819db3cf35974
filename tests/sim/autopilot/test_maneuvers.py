"""How types of vehicles hold places, and know that they are there."""

from __future__ import annotations

from math import pi

import pytest

from mavstack.sim.autopilot.behaviours import Hold
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.autopilot.harness import GUIDED, HOLD, AutopilotHarness


def test_a_copter_has_reached_a_point_when_it_is_near_and_as_high() -> None:
    flight = AutopilotHarness(acceptance_radius=2.0)
    flight.body.place(10.0, 0.0, -10.0, 0.0)
    flight.world.step()
    maneuvers = flight.autopilot.maneuvers
    assert maneuvers.has_reached((11.0, 0.0, -10.5))
    assert not maneuvers.has_reached((13.0, 0.0, -10.0))
    assert not maneuvers.has_reached((10.0, 0.0, -12.0))
    assert maneuvers.has_reached((13.0, 0.0, -10.0), 4.0)


def test_a_rover_is_always_as_high() -> None:
    flight = AutopilotHarness(VehicleType.ROVER)
    assert flight.autopilot.maneuvers.has_reached((0.5, 0.0, -50.0))


def test_a_wing_has_reached_a_point_that_it_has_passed() -> None:
    flight = AutopilotHarness(VehicleType.PLANE)
    maneuvers = flight.autopilot.maneuvers
    maneuvers.go_to((100.0, 0.0, -50.0), start=(0.0, 0.0, -50.0))
    flight.body.place(90.0, 80.0, -50.0, 0.0)
    flight.world.step()
    assert not maneuvers.has_reached((100.0, 0.0, -50.0))
    flight.body.place(101.0, 80.0, -50.0, 0.0)
    flight.world.step()
    assert maneuvers.has_reached((100.0, 0.0, -50.0))


@pytest.mark.fast_cases(5)
@pytest.mark.parametrize(("kind", "circles"), [(kind, kind is VehicleType.PLANE) for kind in VehicleType])
def test_who_circles(kind: VehicleType, circles: bool) -> None:
    assert AutopilotHarness(kind).autopilot.maneuvers.circles == circles


def test_a_vtol_circles_when_it_is_to_fly_forward() -> None:
    flight = AutopilotHarness(VehicleType.VTOL)
    flight.body.transition_to(True)
    assert flight.autopilot.maneuvers.circles


@pytest.mark.flight
def test_near_the_ground_its_height_is_that_of_the_rangefinder() -> None:
    flight = AutopilotHarness().in_the_air(12.0)
    flight.body.drift_barometer(4.0)
    flight.run(2.0)
    assert flight.autopilot.maneuvers.height == pytest.approx(flight.height, abs=0.5)


@pytest.mark.flight
def test_it_comes_to_rest_ahead_of_where_it_is() -> None:
    flight = AutopilotHarness().in_the_air(10.0)
    flight.enter(GUIDED)
    flight.autopilot.guided.fly_velocity(6.0, 0.0, 0.0)
    flight.run(2.5)
    stop = flight.autopilot.maneuvers.stopping_point
    flight.fly(Hold)
    flight.run(8)
    assert stop[0] > 10
    assert flight.distance(stop) < 1.5


@pytest.mark.flight
def test_a_speed_and_a_yaw_that_are_chosen_count_at_once() -> None:
    flight = AutopilotHarness().in_the_air(10.0)
    flight.enter(GUIDED)
    flight.autopilot.guided.go_to((200.0, 0.0, -10.0), speed=3.0)
    flight.run(5)
    assert flight.speed == pytest.approx(3.0, abs=0.5)
    maneuvers = flight.autopilot.maneuvers
    maneuvers.speed = 6.0
    maneuvers.yaw = pi / 2
    maneuvers.reissue()
    flight.run(5)
    assert flight.speed == pytest.approx(6.0, abs=0.7)
    assert flight.body.truth.yaw == pytest.approx(pi / 2, abs=0.1)
    flight.enter(HOLD)
    assert maneuvers.speed is None
    assert maneuvers.yaw is None


@pytest.mark.flight
def test_what_is_repeated_keeps_the_yaw_it_was_given() -> None:
    flight = AutopilotHarness().in_the_air(10.0)
    flight.enter(GUIDED)
    flight.autopilot.guided.go_to((100.0, 0.0, -10.0), yaw=1.0)
    flight.run(4)
    flight.autopilot.maneuvers.speed = 2.0
    flight.autopilot.maneuvers.reissue()
    flight.run(3)
    assert flight.body.truth.yaw == pytest.approx(1.0, abs=0.1)
