"""Coming home, for all types."""

from __future__ import annotations

from math import inf
from types import SimpleNamespace

import pytest

from mavstack.sim.autopilot.behaviours import Hold, ReturnToLaunch
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.autopilot.harness import GUIDED, RETURN, AutopilotHarness


def away(
    kind: VehicleType, north: float, east: float, height: float, **flight_parameters: float
) -> AutopilotHarness:
    """A vehicle that hovers somewhere else."""
    flight = AutopilotHarness(kind, **flight_parameters).in_the_air(height)
    flight.enter(GUIDED)
    flight.autopilot.guided.go_to((north, east, -height))
    flight.run_until(lambda: flight.distance((north, east)) < 1.5, timeout=60)
    flight.track.clear()
    return flight


@pytest.mark.nightly
@pytest.mark.parametrize("kind", [VehicleType.COPTER, VehicleType.VTOL])
def test_it_climbs_returns_at_the_return_altitude_and_lands(kind: VehicleType) -> None:
    flight = away(kind, 60.0, 40.0, 10.0, return_altitude=25.0)
    flight.enter(RETURN)
    flight.run_until(lambda: not flight.autopilot.armed, timeout=120)
    assert flight.distance() < 1.5
    between = [-down for north, east, down in flight.track if 5 < (north**2 + east**2) ** 0.5 < 60]
    assert between
    assert all(height == pytest.approx(25.0, abs=2.0) for height in between)


@pytest.mark.flight
def test_a_higher_vehicle_keeps_its_altitude() -> None:
    flight = away(VehicleType.COPTER, 50.0, 0.0, 35.0, return_altitude=20.0)
    flight.enter(RETURN)
    flight.run_until(lambda: flight.distance() < 3, timeout=30)
    assert flight.height == pytest.approx(35.0, abs=1.5)


@pytest.mark.flight
def test_near_home_it_climbs_only_a_cone() -> None:
    flight = away(VehicleType.COPTER, 10.0, 0.0, 5.0, return_altitude=50.0, return_cone_slope=1.5)
    away_from_home = flight.distance()
    flight.enter(RETURN)
    flight.run_until(lambda: not flight.autopilot.armed, timeout=120)
    assert max(-down for _, _, down in flight.track) == pytest.approx(1.5 * away_from_home, abs=1.5)


@pytest.mark.nightly
def test_it_waits_lower_and_for_ever_if_that_is_wanted() -> None:
    flight = away(VehicleType.COPTER, 40.0, 0.0, 30.0, return_descend_altitude=12.0, return_loiter_time=inf)
    flight.enter(RETURN)
    flight.run(90)
    assert flight.autopilot.armed
    assert flight.height == pytest.approx(12.0, abs=1.0)
    assert flight.distance() < 1.5


@pytest.mark.nightly
def test_a_rally_point_is_where_it_comes_back_to() -> None:
    flight = away(VehicleType.COPTER, 60.0, 0.0, 20.0)
    flight.autopilot.rally = SimpleNamespace(destination=lambda: (30.0, 20.0, 0.0))
    flight.enter(RETURN)
    flight.run_until(lambda: not flight.autopilot.armed, timeout=120)
    assert flight.distance((30.0, 20.0)) < 1.5


def test_on_the_ground_it_just_disarms() -> None:
    flight = AutopilotHarness()
    flight.arm()
    flight.enter(RETURN)
    flight.run_until(lambda: not flight.autopilot.armed, timeout=5)
    assert flight.height < 0.1


@pytest.mark.nightly
def test_a_plane_circles_home_for_ever_if_that_is_wanted() -> None:
    flight = AutopilotHarness(VehicleType.PLANE, return_loiter_time=inf, return_altitude=70.0).in_the_air(
        40.0
    )
    flight.enter(GUIDED)
    flight.autopilot.guided.go_to((700.0, 0.0, -40.0))
    flight.run_until(lambda: flight.body.truth.north > 600, timeout=90)
    flight.enter(RETURN)
    flight.run(90)
    for _ in range(30):
        flight.run(1)
        assert flight.distance() == pytest.approx(60.0, abs=20.0)
        assert flight.height == pytest.approx(70.0, abs=5.0)


@pytest.mark.nightly
def test_a_plane_lands_at_home() -> None:
    flight = AutopilotHarness(VehicleType.PLANE, return_loiter_time=5.0).in_the_air(50.0)
    flight.enter(RETURN)
    flight.run_until(lambda: not flight.autopilot.armed, timeout=300)
    assert flight.distance() < 130.0


@pytest.mark.nightly
def test_a_vtol_comes_back_on_its_wing_and_lands_hovering() -> None:
    flight = AutopilotHarness(VehicleType.VTOL).in_the_air(40.0)
    flight.fly(lambda autopilot: Hold(autopilot, forward=True))
    flight.autopilot.guided.go_to((500.0, 0.0, -40.0))
    flight.run_until(lambda: flight.distance() > 400, timeout=60)
    flight.enter(RETURN)
    flight.run(5)
    assert flight.body.transition == 1.0
    flight.run_until(lambda: not flight.autopilot.armed, timeout=240)
    assert flight.distance() < 2.0


@pytest.mark.nightly
def test_a_vtol_can_be_configured_to_return_hovering() -> None:
    flight = AutopilotHarness(VehicleType.VTOL).in_the_air(40.0)
    flight.fly(lambda autopilot: Hold(autopilot, forward=True))
    flight.run(20)
    flight.fly(lambda autopilot: ReturnToLaunch(autopilot, forward=False))
    flight.run_until(lambda: flight.body.transition == 0.0, timeout=20)
    flight.run_until(lambda: not flight.autopilot.armed, timeout=240)
    assert flight.distance() < 2.0


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("kind", [VehicleType.ROVER, VehicleType.BOAT])
def test_a_rover_returns_and_stays(kind: VehicleType) -> None:
    flight = AutopilotHarness(kind)
    flight.arm()
    flight.enter(GUIDED)
    flight.autopilot.guided.go_to((30.0, 20.0, 0.0))
    flight.run_until(lambda: flight.distance((30.0, 20.0)) < 3, timeout=60)
    flight.enter(RETURN)
    flight.run(45)
    assert flight.distance() < 3.0
    assert flight.speed < 0.5
    assert flight.autopilot.armed


@pytest.mark.nightly
def test_a_sub_returns_at_its_depth_and_surfaces() -> None:
    flight = AutopilotHarness(VehicleType.SUB)
    flight.arm()
    flight.enter(GUIDED)
    flight.autopilot.guided.go_to((20.0, 0.0, 5.0))
    flight.run_until(lambda: flight.distance((20.0, 0.0)) < 2 and flight.body.truth.down > 4, timeout=90)
    flight.enter(RETURN)
    flight.run_until(lambda: flight.distance() < 5, timeout=60)
    assert flight.body.truth.down == pytest.approx(5.0, abs=1.0)
    flight.run_until(lambda: flight.body.truth.down < 0.5, timeout=60)


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("altitude", "wait_at", "height"), [(-inf, inf, 45.0), (30.0, inf, 30.0), (30.0, 40.0, 40.0)]
)
def test_a_plane_returns_at_the_height_of_its_flight_parameters(
    altitude: float, wait_at: float, height: float
) -> None:
    flight = AutopilotHarness(
        VehicleType.PLANE,
        return_loiter_time=inf,
        return_altitude=altitude,
        return_descend_altitude=wait_at,
    ).in_the_air(45.0)
    flight.run(20)
    flight.enter(RETURN)
    flight.run(80)
    assert flight.height == pytest.approx(height, abs=5.0)
