"""Take-offs of all that fly."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.sim.autopilot.behaviours import Takeoff
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.autopilot.harness import TAKEOFF, AutopilotHarness

HOVERING = [VehicleType.COPTER, VehicleType.VTOL]
LANDED = common.MavLandedState


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", HOVERING)
def test_it_rises_straight_to_its_altitude_and_stays(kind: VehicleType) -> None:
    flight = AutopilotHarness(kind, takeoff_altitude=12.0)
    flight.arm()
    flight.enter(TAKEOFF)
    flight.run_until(lambda: flight.autopilot.landed_state == LANDED.TAKEOFF, timeout=5)
    flight.run_until(lambda: flight.autopilot.landed_state == LANDED.IN_AIR, timeout=20)
    flight.run(10)
    assert flight.height == pytest.approx(12.0, abs=1.0)
    assert max(-down for _, _, down in flight.track) < 13.0
    assert flight.distance() < 1.5
    assert flight.speed < 0.5


@pytest.mark.flight
def test_it_is_up_at_a_place_in_local_metres() -> None:
    flight = AutopilotHarness()
    flight.arm()
    flight.fly(lambda autopilot: Takeoff(autopilot, down=-7.0))
    flight.run(15)
    assert flight.height == pytest.approx(7.0, abs=1.0)


@pytest.mark.flight
def test_a_take_off_in_the_air_never_sinks() -> None:
    flight = AutopilotHarness().in_the_air(20.0)
    flight.fly(lambda autopilot: Takeoff(autopilot, 5.0))
    flight.run(10)
    assert flight.height == pytest.approx(20.0, abs=1.0)


@pytest.mark.flight
def test_a_take_off_in_the_air_counts_from_home() -> None:
    flight = AutopilotHarness().in_the_air(10.0)
    flight.fly(lambda autopilot: Takeoff(autopilot, 20.0))
    flight.run(15)
    assert flight.height == pytest.approx(20.0, abs=1.0)


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("wind", [0.0, 5.0])
def test_a_plane_rolls_climbs_ahead_and_circles(wind: float) -> None:
    flight = AutopilotHarness(VehicleType.PLANE)
    flight.world.set_wind(speed=wind, direction=0.0)
    flight.arm()
    flight.fly(lambda autopilot: Takeoff(autopilot, 50.0))
    flight.run_until(lambda: flight.autopilot.landed_state == LANDED.TAKEOFF, timeout=15)
    assert flight.body.truth.north > 5.0
    flight.run_until(lambda: flight.height > 40.0, timeout=40)
    assert abs(flight.body.truth.east) < 60.0, "it climbs ahead"
    flight.run(60)
    assert flight.height == pytest.approx(50.0, abs=5.0)
    assert flight.distance() < 1.6 * flight.flight_parameters.loiter_radius
    assert flight.autopilot.landed_state == LANDED.IN_AIR


@pytest.mark.nightly
def test_a_vtol_continues_in_forward_flight() -> None:
    flight = AutopilotHarness(VehicleType.VTOL)
    flight.arm()
    flight.fly(lambda autopilot: Takeoff(autopilot, 30.0, forward=True))
    flight.run(60)
    assert flight.body.transition == 1.0
    assert flight.height == pytest.approx(30.0, abs=5.0)
    assert flight.speed > 12.0
    assert flight.distance() < 200.0


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", [VehicleType.ROVER, VehicleType.BOAT, VehicleType.SUB])
def test_what_does_not_fly_stays(kind: VehicleType) -> None:
    flight = AutopilotHarness(kind)
    flight.arm()
    flight.enter(TAKEOFF)
    flight.run(10)
    assert flight.distance() < 2.0
    assert flight.height <= 0.1


def test_disarming_while_it_rises_lets_it_fall() -> None:
    flight = AutopilotHarness()
    flight.arm()
    flight.enter(TAKEOFF)
    flight.run_until(lambda: flight.height > 3, timeout=10)
    flight.autopilot.disarm("test")
    flight.run_until(lambda: flight.body.on_ground, timeout=5)
    assert flight.autopilot.behaviour is None
