"""The attitude setpoint: the body follows it with a lag, and nothing else is read from a loop that is off."""

from __future__ import annotations

import pytest

from mavstack.sim.vehicle_types import VehicleType
from tests.sim.motion.flights import single_body, step_for


def _hovering():
    world, body = single_body(VehicleType.COPTER)
    body.place(0.0, 0.0, -20.0, 0.0)
    body.go_to(0.0, 0.0, -20.0)
    step_for(world, 2.0)
    return world, body


def test_the_body_follows_the_setpoint_with_a_lag():
    world, body = _hovering()
    body.hold_attitude(0.3, -0.2, None, 0.6)
    step_for(world, 0.1)
    setpoint = body.attitude_setpoint
    assert (setpoint.roll, setpoint.pitch) == (0.3, -0.2)
    assert 0.0 < body.truth.roll < 0.2, "the body leans at once"
    assert setpoint.roll_rate > body.truth.roll_rate > 0.0, "the rates have a lag too"
    step_for(world, 1.5)
    assert body.truth.roll == pytest.approx(0.3, abs=0.03)


def test_the_heading_is_ahead_of_a_turning_copter():
    world, body = _hovering()
    body.go_to(0.0, 0.0, -20.0, yaw=body.truth.yaw + 1.0)
    step_for(world, 0.3)
    ahead = body.attitude_setpoint.yaw - body.estimate.yaw
    assert 0.3 < ahead <= 1.0


def test_body_rates_leave_the_tilts_as_they_are():
    world, body = _hovering()
    body.hold_rates(0.5, 0.0, 0.0, 0.5)
    step_for(world, 0.1)
    setpoint = body.attitude_setpoint
    assert (setpoint.roll, setpoint.pitch) == (body.estimate.roll, body.estimate.pitch)
    assert setpoint.roll_rate == 0.5


@pytest.mark.parametrize("vehicle_type", [VehicleType.ROVER, VehicleType.BOAT])
def test_a_vehicle_on_the_surface_asks_for_turns_alone(vehicle_type):
    world, body = single_body(vehicle_type)
    body.go_to(0.0, -30.0, 0.0)
    step_for(world, 1.0)
    setpoint = body.attitude_setpoint
    assert (setpoint.roll, setpoint.pitch) == (body.estimate.roll, body.estimate.pitch)
    assert setpoint.yaw_rate != 0.0
    assert setpoint.yaw_rate * (setpoint.yaw - body.estimate.yaw) > 0.0


def test_a_wing_asks_for_its_present_heading():
    world, body = single_body(VehicleType.PLANE)
    body.place(0.0, 0.0, -100.0, 0.0)
    body.go_to(0.0, -500.0, -100.0)
    step_for(world, 2.0)
    assert body.attitude_setpoint.roll < -0.2
    assert body.attitude_setpoint.yaw == pytest.approx(body.estimate.yaw)


def test_without_motors_the_setpoint_is_the_estimate():
    world, body = single_body(VehicleType.COPTER)
    step_for(world, 0.5)
    estimate = body.estimate
    assert body.attitude_setpoint[:3] == (estimate.roll, estimate.pitch, estimate.yaw)
