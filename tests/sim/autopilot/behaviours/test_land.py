"""Landings of all types."""

from __future__ import annotations

from math import pi

import pytest

from mavstack.dialects import common
from mavstack.sim.autopilot.behaviours import Hold, Land
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.autopilot.harness import LAND, AutopilotHarness

LANDED = common.MavLandedState


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("kind", [VehicleType.COPTER, VehicleType.VTOL])
def test_it_sinks_slows_down_touches_down_and_disarms(kind: VehicleType) -> None:
    flight = AutopilotHarness(kind).in_the_air(20.0)
    flight.enter(LAND)
    flight.run(3)
    assert flight.body.truth.velocity_down == pytest.approx(1.5, abs=0.4)
    assert flight.autopilot.landed_state == LANDED.LANDING
    flight.run_until(lambda: flight.height < 6, timeout=20)
    assert flight.body.truth.velocity_down == pytest.approx(0.5, abs=0.3)
    flight.run_until(lambda: flight.body.on_ground, timeout=20)
    assert flight.distance() < 2.0
    flight.run_until(lambda: not flight.autopilot.armed, timeout=3)
    assert flight.autopilot.landed_state == LANDED.ON_GROUND


@pytest.mark.flight
def test_it_lands_at_the_commanded_position() -> None:
    flight = AutopilotHarness().in_the_air(10.0)
    flight.fly(lambda autopilot: Land(autopilot, (25.0, -15.0, 0.0), yaw=pi / 2))
    flight.run_until(lambda: not flight.autopilot.armed, timeout=60)
    assert flight.distance((25.0, -15.0)) < 1.5
    assert flight.body.truth.yaw == pytest.approx(pi / 2, abs=0.1)


@pytest.mark.flight
def test_it_stops_before_it_comes_down_from_full_speed() -> None:
    flight = AutopilotHarness().in_the_air(15.0)
    flight.fly(Hold)
    flight.autopilot.guided.fly_velocity(8.0, 0.0, 0.0)
    flight.run(2.5)
    assert flight.speed > 4
    flight.enter(LAND)
    flight.run_until(lambda: not flight.autopilot.armed, timeout=60)
    assert flight.body.truth.north < 40


@pytest.mark.flight
def test_wind_does_not_carry_it_away() -> None:
    flight = AutopilotHarness()
    flight.world.set_wind(speed=6.0, direction=270.0, turbulence=0.2)
    flight.in_the_air(15.0)
    flight.enter(LAND)
    flight.run_until(lambda: not flight.autopilot.armed, timeout=60)
    assert flight.distance() < 4.0


@pytest.mark.flight
def test_without_a_position_it_comes_down_level() -> None:
    flight = AutopilotHarness().in_the_air(15.0)
    flight.body.fail_gps(True)
    flight.run_until(lambda: not flight.autopilot.has_position, timeout=60)
    flight.autopilot._begin(flight.autopilot.find_mode(LAND), "a mode that needs no position")
    flight.run_until(lambda: not flight.autopilot.armed, timeout=90)
    fastest = max(abs(b[2] - a[2]) for a, b in zip(flight.track, flight.track[1:], strict=False)) / 0.1
    assert fastest < 4.0


def test_landing_on_the_ground_disarms() -> None:
    flight = AutopilotHarness()
    flight.arm()
    flight.enter(LAND)
    flight.run_until(lambda: not flight.autopilot.armed, timeout=3)
    assert flight.height < 0.1


@pytest.mark.nightly
@pytest.mark.parametrize("direction", [None, 0.0, 100.0])
def test_a_plane_approaches_glides_flares_and_rolls_out(direction: float | None) -> None:
    flight = AutopilotHarness(VehicleType.PLANE)
    if direction is not None:
        flight.world.set_wind(speed=4.0, direction=direction)
    flight.in_the_air(60.0)
    flight.fly(lambda autopilot: Land(autopilot, (100.0, 50.0, 0.0)))
    sinking = []

    def down() -> bool:
        if not flight.body.on_ground:
            sinking.append(flight.body.truth.velocity_down)
        return flight.body.on_ground

    flight.run_until(down, timeout=240)
    assert sinking[-1] < 1.5, "it touches down softly"
    assert flight.distance((100.0, 50.0)) < 60.0
    if direction is not None:
        headwind = (flight.body.truth.yaw * 180 / pi - direction + 180) % 360 - 180
        assert abs(headwind) < 35
    flight.run_until(lambda: not flight.autopilot.armed, timeout=40)
    assert flight.distance((100.0, 50.0)) < 100.0


@pytest.mark.nightly
def test_a_plane_in_a_mission_lands_from_where_it_is() -> None:
    flight = AutopilotHarness(VehicleType.PLANE).in_the_air(40.0)
    flight.fly(Hold)
    flight.autopilot.guided.go_to((-600.0, 0.0, -40.0))
    flight.run_until(lambda: flight.body.truth.north < -450, timeout=90)
    flight.fly(lambda autopilot: Land(autopilot, (0.0, 0.0, 0.0), direct=True))
    flight.run_until(lambda: not flight.autopilot.armed, timeout=120)
    assert flight.distance() < 150.0


@pytest.mark.nightly
def test_a_vtol_on_its_wing_hovers_and_lands() -> None:
    flight = AutopilotHarness(VehicleType.VTOL).in_the_air(40.0)
    flight.fly(lambda autopilot: Hold(autopilot, forward=True))
    flight.run(30)
    assert flight.body.transition == 1.0
    flight.fly(lambda autopilot: Land(autopilot, (0.0, 0.0, 0.0)))
    flight.run_until(lambda: not flight.autopilot.armed, timeout=120)
    assert flight.body.transition == 0.0
    assert flight.distance() < 2.0


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", [VehicleType.ROVER, VehicleType.BOAT])
def test_what_drives_stops(kind: VehicleType) -> None:
    flight = AutopilotHarness(kind)
    flight.arm()
    flight.fly(Hold)
    flight.autopilot.guided.go_to((100.0, 0.0, 0.0))
    flight.run(10)
    assert flight.speed > 1.0
    flight.enter(LAND)
    flight.run(15)
    assert flight.speed < 0.3
    assert flight.distance() < 60


@pytest.mark.flight
def test_a_sub_surfaces() -> None:
    flight = AutopilotHarness(VehicleType.SUB)
    flight.arm()
    flight.fly(Hold)
    flight.autopilot.guided.go_to((5.0, 0.0, 8.0))
    flight.run_until(lambda: flight.body.truth.down > 7, timeout=60)
    flight.enter(LAND)
    flight.run_until(lambda: flight.body.truth.down < 0.5, timeout=60)
