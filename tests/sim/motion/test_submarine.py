from __future__ import annotations

import pytest

from mavstack.sim.vehicle_types import VehicleType
from tests.sim.motion.flights import (
    absolute_angle,
    distance_to,
    horizontal_distance,
    record,
    single_body,
    speed,
    step_for,
)


def diving(depth: float = 10.0):
    world, body = single_body(VehicleType.SUB, wind=8.0)
    body.place(0, 0, depth, 0)
    body.go_to(0, 0, depth)
    step_for(world, 5)
    return world, body


@pytest.mark.flight
def test_dives_and_holds_its_depth():
    world, body = single_body(VehicleType.SUB)
    body.go_to(0, 0, 8)
    step_for(world, 28)
    assert all(abs(m.down - 8) < 0.6 for m in record(world, body, 10))


@pytest.mark.flight
def test_goes_to_a_point_and_holds_there():
    world, body = diving()
    body.go_to(10, -5, 12)
    step_for(world, 25)
    motions = record(world, body, 8)
    assert all(distance_to(m, (10, -5, 12)) < 1.2 for m in motions)
    assert all(absolute_angle(m.roll) < 0.1 and absolute_angle(m.pitch) < 0.1 for m in motions)


@pytest.mark.flight
def test_circles():
    world, body = diving()
    body.circle(0, 0, 10, 5)
    step_for(world, 20)
    assert all(abs(horizontal_distance(m, 0, 0) - 5) < 1.2 for m in record(world, body, 15))


@pytest.mark.flight
def test_speed_is_limited_by_the_thrusters():
    world, body = diving()
    body.fly_velocity(50, 0, 0)
    step_for(world, 10)
    assert 1.0 < speed(body.truth) < 1.8


@pytest.mark.flight
def test_floats_up_when_stopped_and_stays_at_the_surface():
    world, body = diving(2.0)
    body.stop()
    step_for(world, 20)
    assert body.truth.down == 0.0
    assert body.on_ground
    body.fly_velocity(0, 0, -1)
    step_for(world, 2)
    assert body.truth.down == 0.0


@pytest.mark.flight
def test_rests_on_the_bottom():
    world, body = diving(39.0)
    body.fly_velocity(0, 0, 0.5)
    step_for(world, 6)
    assert body.truth.down == 40.0
    assert body.on_ground
    assert body.truth.velocity_down == 0.0


@pytest.mark.flight
def test_sticks_and_attitudes():
    world, body = diving()
    body.sticks(0, 1.0, 0, 0)
    step_for(world, 3)
    assert body.truth.velocity_north > 0.6
    body.sticks(0, 0, 1.0, 0)
    step_for(world, 3)
    assert body.truth.velocity_down < -0.5
    body.hold_attitude(0.3, 0, 0, 0.5)
    step_for(world, 4)
    assert abs(body.truth.roll - 0.3) < 0.06
    assert body.servos[0] > 0


def test_water_pressure_grows_with_depth():
    world, body = diving(20.0)
    deep = body.sensors.pressure
    body.place(0, 0, 1.0, 0)
    assert 1500 < deep - body.sensors.pressure < 2200
    assert body.sensors.temperature > 0
    assert world.time > 0
