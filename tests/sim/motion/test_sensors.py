from __future__ import annotations

import math

import pytest

from mavstack.sim.motion import World
from mavstack.sim.vehicle_types import Home, VehicleType
from tests.sim.motion.flights import absolute_angle, single_body, step_for


def test_readings_at_rest():
    world, body = single_body(VehicleType.COPTER)
    step_for(world, 1)
    readings = body.sensors
    assert readings[:3] == pytest.approx((0, 0, 0), abs=0.02)
    assert readings[3:6] == pytest.approx((0, 0, -9.81), abs=0.4)
    assert readings.pressure == pytest.approx(956, abs=2)
    assert readings.temperature == pytest.approx(11.8, abs=0.5)
    assert readings.gps_latitude == pytest.approx(47.4, abs=1e-4)
    assert readings.gps_altitude == pytest.approx(488, abs=5)
    assert absolute_angle(readings.heading - math.pi / 2) < 0.08
    assert math.isnan(readings.distance)


def test_magnetic_field_points_north_and_down():
    world = World()
    body = world.add(VehicleType.ROVER, Home(47.4, 8.5, 0, 0))
    world.step()
    readings = body.sensors
    assert readings.magnetic_x == pytest.approx(0.21, abs=0.02)
    assert readings.magnetic_y == pytest.approx(0.0, abs=0.02)
    assert readings.magnetic_z == pytest.approx(0.456, abs=0.02)


def test_rangefinder_pitot_and_barometer_in_flight():
    world, body = single_body(VehicleType.PLANE)
    body.place(0, 0, -30, 0)
    body.fly_velocity(18, 0, 0)
    step_for(world, 6)
    readings = body.sensors
    assert readings.distance == pytest.approx(-body.truth.down, abs=1.5)
    assert readings.differential_pressure == pytest.approx(0.00613 * body.airspeed**2, abs=0.2)
    body.place(0, 0, -300, 0)
    assert math.isnan(body.sensors.distance)
    assert readings.pressure - body.sensors.pressure > 20


def test_gps_lags_and_reports_at_five_hertz():
    world, body = single_body(VehicleType.ROVER)
    body.fly_velocity(0, 4, 0)
    step_for(world, 5)
    places = []
    for _ in range(100):
        world.step()
        places.append(body.sensors.gps_longitude)
    assert 9 <= len(set(places)) <= 11
    east = body.frame.to_local(body.sensors.gps_latitude, places[-1], 0)[1]
    assert east < body.estimate.east + 0.2


def test_reading_sensors_does_not_change_the_motion():
    unread_world, unread_body = single_body(VehicleType.COPTER)
    read_world, read_body = single_body(VehicleType.COPTER)
    for body in (unread_body, read_body):
        body.go_to(10, 0, -10)
    for _ in range(100):
        unread_world.step()
        read_world.step()
        assert read_body.sensors
    assert unread_body.truth == read_body.truth
    assert unread_body.sensors == read_body.sensors


def test_free_fall_is_weightless():
    world, body = single_body(VehicleType.COPTER)
    body.place(0, 0, -50, 0)
    body.stop()
    step_for(world, 0.3)
    assert abs(body.sensors.acceleration_z) < 1.0


@pytest.mark.parametrize("vehicle_type", list(VehicleType))
def test_sixteen_servo_outputs(vehicle_type):
    world, body = single_body(vehicle_type)
    body.go_to(20, 0, 0)
    step_for(world, 1)
    assert len(body.servos) == 16
    assert all(pulse == 0 or 1000 <= pulse <= 2000 for pulse in body.servos)
    assert any(body.servos)
