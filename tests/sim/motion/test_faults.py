from __future__ import annotations

import math

import pytest

from mavstack.sim.vehicle_types import VehicleType
from tests.sim.motion.flights import absolute_angle, horizontal_distance, record, single_body, step_for


def hovering(height: float = 20.0, seed: int = 1):
    world, body = single_body(VehicleType.COPTER, seed=seed)
    body.place(0, 0, -height, 0)
    body.go_to(0, 0, -height)
    step_for(world, 4)
    return world, body


def test_no_faults():
    _, body = hovering()
    health = body.health
    assert health[:5] == (True,) * 5
    assert max(health[5:]) < 0.6
    assert body.sensors.gps_fix == 3
    assert math.dist(body.truth[:3], body.estimate[:3]) < 2.5


@pytest.mark.nightly
@pytest.mark.flight
def test_position_becomes_invalid_after_gps_loss():
    world, body = hovering()
    body.fail_gps(True)
    assert body.sensors.gps_fix <= 1
    assert body.sensors.gps_satellites == 0
    step_for(world, 2)
    assert body.health.horizontal
    step_for(world, 8)
    assert not body.health.horizontal
    assert body.health.position_variance > 1
    step_for(world, 15)
    error = horizontal_distance(body.truth, body.estimate.north, body.estimate.east)
    assert 4 < error < 60
    assert horizontal_distance(body.truth, 0, 0) > 3
    assert abs(body.truth.down + 20) < 1
    body.fail_gps(False)
    step_for(world, 25)
    assert body.health.horizontal
    assert horizontal_distance(body.truth, 0, 0) < 3


@pytest.mark.flight
def test_spoofed_gps_moves_the_vehicle():
    world, body = hovering()
    body.spoof_gps(30, 0)
    motions = record(world, body, 30)
    assert horizontal_distance(body.estimate, 0, 0) < 1.5
    assert horizontal_distance(motions[-1], -30, 0) < 2.5
    assert body.sensors.gps_latitude > body.frame.to_global(*body.truth[:3])[0] + 0.0002


@pytest.mark.flight
def test_compass_offset_turns_the_estimate():
    world, body = hovering()
    body.offset_compass(0.4)
    assert body.health.compass_variance > 0.5
    step_for(world, 12)
    assert absolute_angle(body.estimate.yaw - body.truth.yaw - 0.4) < 0.06
    assert absolute_angle(body.sensors.heading - body.truth.yaw - 0.4) < 0.06
    readings = body.sensors
    assert absolute_angle(math.atan2(-readings.magnetic_y, readings.magnetic_x) - body.estimate.yaw) < 0.3


@pytest.mark.flight
def test_barometer_drift_changes_the_altitude():
    world, body = hovering(30)
    pressure = body.sensors.pressure
    body.drift_barometer(5)
    assert body.sensors.pressure - pressure > 0.3
    step_for(world, 15)
    assert abs(body.estimate.down + 30) < 1
    assert abs(body.truth.down + 35) < 1
    assert body.health.height_variance > 0.4


def test_battery_sag():
    world, body = hovering()
    before = body.battery.voltage
    body.sag_battery(2.0)
    step_for(world, 1)
    assert before - body.battery.voltage == pytest.approx(2.0, abs=0.3)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("motor", [1, 2, 3, 4])
def test_quad_with_one_failed_motor_spins_and_comes_down(motor):
    world, body = hovering(40)
    body.fail_motor(motor, True)
    step_for(world, 3)
    assert abs(body.truth.yaw_rate) > 4
    assert (body.truth.yaw_rate < 0) == (motor < 3)
    step_for(world, 22)
    assert body.on_ground


def test_quad_with_two_failed_motors_falls():
    world, body = hovering(40)
    body.fail_motor(1, True)
    body.fail_motor(3, True)
    assert step_for(world, 10, lambda: body.on_ground) < 6


@pytest.mark.flight
def test_repaired_motor_lifts_again():
    world, body = hovering(60)
    body.fail_motor(2, True)
    step_for(world, 2)
    body.fail_motor(2, False)
    step_for(world, 15)
    assert abs(body.truth.down + 60) < 1.5


def test_unknown_motor_number_changes_nothing():
    world, body = hovering()
    body.fail_motor(9, True)
    body.fail_motor(0, True)
    step_for(world, 3)
    assert abs(body.truth.down + 20) < 1


@pytest.mark.parametrize("vehicle_type", [VehicleType.ROVER, VehicleType.BOAT])
def test_surface_vehicle_with_failed_motors_stays(vehicle_type):
    world, body = single_body(vehicle_type)
    body.fail_motor(1, True)
    body.fail_motor(2, True)
    body.fly_velocity(3, 0, 0)
    step_for(world, 5)
    assert horizontal_distance(body.truth, 0, 0) < 0.1


@pytest.mark.flight
def test_vtol_with_failed_pusher_stays_in_hover():
    world, body = single_body(VehicleType.VTOL)
    body.place(0, 0, -60, 0)
    body.fail_motor(5, True)
    body.go_to(2000, 0, -60)
    body.transition_to(True)
    step_for(world, 15)
    assert body.transition < 1
    assert abs(body.truth.down + 60) < 3


def test_sub_with_fewer_thrusters_is_slower():
    world, body = single_body(VehicleType.SUB)
    body.place(0, 0, 10, 0)
    for motor in (1, 2, 3):
        body.fail_motor(motor, True)
    body.fly_velocity(1.5, 0, 0)
    step_for(world, 10)
    assert 0.3 < body.truth.velocity_north < 1.15
