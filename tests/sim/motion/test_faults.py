from __future__ import annotations

import math

import pytest

from mavstack.sim.vehicle_types import VehicleType
from tests.sim.motion.flights import alone, away, fly, turned, watch


def hovering(height: float = 20.0, seed: int = 1):
    world, body = alone(VehicleType.COPTER, seed=seed)
    body.place(0, 0, -height, 0)
    body.go_to(0, 0, -height)
    fly(world, 4)
    return world, body


def test_all_well():
    _, body = hovering()
    health = body.health
    assert health[:5] == (True,) * 5
    assert max(health[5:]) < 0.6
    assert body.sensors.gps_fix == 3
    assert math.dist(body.truth[:3], body.estimate[:3]) < 2.5


def test_lost_gps_drifts_until_the_place_is_no_longer_known():
    world, body = hovering()
    body.fail_gps(True)
    assert body.sensors.gps_fix <= 1
    assert body.sensors.gps_satellites == 0
    fly(world, 2)
    assert body.health.horizontal
    fly(world, 8)
    assert not body.health.horizontal
    assert body.health.position_variance > 1
    fly(world, 15)
    error = away(body.truth, body.estimate.north, body.estimate.east)
    assert 4 < error < 60
    assert away(body.truth, 0, 0) > 3
    assert abs(body.truth.down + 20) < 1
    body.fail_gps(False)
    fly(world, 25)
    assert body.health.horizontal
    assert away(body.truth, 0, 0) < 3


def test_spoofed_gps_takes_the_vehicle_away():
    world, body = hovering()
    body.spoof_gps(30, 0)
    seen = watch(world, body, 30)
    assert away(body.estimate, 0, 0) < 1.5
    assert away(seen[-1], -30, 0) < 2.5
    assert body.sensors.gps_latitude > body.frame.to_global(*body.truth[:3])[0] + 0.0002


def test_turned_compass_turns_the_estimate():
    world, body = hovering()
    body.offset_compass(0.4)
    assert body.health.compass_variance > 0.5
    fly(world, 12)
    assert turned(body.estimate.yaw - body.truth.yaw - 0.4) < 0.06
    assert turned(body.sensors.heading - body.truth.yaw - 0.4) < 0.06
    readings = body.sensors
    assert turned(math.atan2(-readings.magnetic_y, readings.magnetic_x) - body.estimate.yaw) < 0.3


def test_drifting_barometer_changes_the_altitude_flown():
    world, body = hovering(30)
    pressure = body.sensors.pressure
    body.drift_barometer(5)
    assert body.sensors.pressure - pressure > 0.3
    fly(world, 15)
    assert abs(body.estimate.down + 30) < 1
    assert abs(body.truth.down + 35) < 1
    assert body.health.height_variance > 0.4


def test_sagging_battery():
    world, body = hovering()
    before = body.battery.voltage
    body.sag_battery(2.0)
    fly(world, 1)
    assert before - body.battery.voltage == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("motor", [1, 2, 3, 4])
def test_quad_without_a_motor_spins_and_comes_down(motor):
    world, body = hovering(40)
    body.fail_motor(motor, True)
    fly(world, 3)
    assert abs(body.truth.yaw_rate) > 4
    assert (body.truth.yaw_rate < 0) == (motor < 3)
    fly(world, 22)
    assert body.on_ground


def test_quad_without_two_motors_falls():
    world, body = hovering(40)
    body.fail_motor(1, True)
    body.fail_motor(3, True)
    assert fly(world, 10, lambda: body.on_ground) < 6


def test_repaired_motor_lifts_again():
    world, body = hovering(60)
    body.fail_motor(2, True)
    fly(world, 2)
    body.fail_motor(2, False)
    fly(world, 15)
    assert abs(body.truth.down + 60) < 1.5


def test_motor_nobody_has():
    world, body = hovering()
    body.fail_motor(9, True)
    body.fail_motor(0, True)
    fly(world, 3)
    assert abs(body.truth.down + 20) < 1


@pytest.mark.parametrize("kind", [VehicleType.ROVER, VehicleType.BOAT])
def test_surface_vehicle_without_motors_stays(kind):
    world, body = alone(kind)
    body.fail_motor(1, True)
    body.fail_motor(2, True)
    body.fly_velocity(3, 0, 0)
    fly(world, 5)
    assert away(body.truth, 0, 0) < 0.1


def test_vtol_without_pusher_does_not_reach_its_wing():
    world, body = alone(VehicleType.VTOL)
    body.place(0, 0, -60, 0)
    body.fail_motor(5, True)
    body.go_to(2000, 0, -60)
    body.transition_to(True)
    fly(world, 15)
    assert body.transition < 1
    assert abs(body.truth.down + 60) < 3


def test_sub_with_fewer_thrusters_is_slower():
    world, body = alone(VehicleType.SUB)
    body.place(0, 0, 10, 0)
    for motor in (1, 2, 3):
        body.fail_motor(motor, True)
    body.fly_velocity(1.5, 0, 0)
    fly(world, 10)
    assert 0.3 < body.truth.velocity_north < 1.15
