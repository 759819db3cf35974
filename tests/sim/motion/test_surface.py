from __future__ import annotations

import math

import pytest

from mavstack.sim.motion import World
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.motion.flights import (
    HOME,
    absolute_angle,
    horizontal_distance,
    record_all,
    single_body,
    speed,
    step_for,
)

ROVER, BOAT = VehicleType.ROVER, VehicleType.BOAT


@pytest.fixture(params=[0.0, 8.0])
def pair(request):
    """Return a world with a rover and a boat, and wind."""
    world = World(seed=1)
    world.set_wind(request.param, 270.0, 0.2)
    return world, [world.add(vehicle_type, HOME) for vehicle_type in (ROVER, BOAT)]


@pytest.mark.flight_cases(1)
@pytest.mark.flight
def test_go_to_a_point_and_hold_there(pair):
    world, bodies = pair
    for body in bodies:
        body.go_to(30, 20, 0)
    step_for(world, 35)
    for motions, bound in zip(record_all(world, bodies, 15), (1.6, 3.2), strict=True):
        assert all(horizontal_distance(m, 30, 20) < bound for m in motions)
        assert all(m.down == 0.0 for m in motions)


@pytest.mark.fast_cases(1)
def test_follow_a_line(pair):
    world, bodies = pair
    for body in bodies:
        body.go_to(60, 5, 0, start=(0, 5, 0))
    step_for(world, 12)
    for motions in record_all(world, bodies, 15):
        assert all(abs(m.east - 5) < 1.8 for m in motions if m.north < 58)


@pytest.mark.flight_cases(1)
@pytest.mark.flight
def test_circle(pair):
    world, bodies = pair
    for body in bodies:
        body.circle(0, 0, 0, -10)
    step_for(world, 35)
    for motions in record_all(world, bodies, 15):
        assert all(abs(horizontal_distance(m, 0, 0) - 10) < 3 for m in motions)
        assert all(m.north * m.velocity_east < m.east * m.velocity_north for m in motions)


@pytest.mark.fast_cases(1)
def test_speed_and_heading_of_a_velocity(pair):
    world, bodies = pair
    for body in bodies:
        body.fly_velocity(0, 2, 0)
    step_for(world, 12)
    for body in bodies:
        assert abs(body.truth.velocity_east - 2) < 0.3
        assert absolute_angle(body.truth.yaw - math.pi / 2) < 0.2
        body.fly_velocity(0, 100, 0)
    step_for(world, 10)
    for body, max_speed in zip(bodies, (5.2, 3.3), strict=True):
        assert 0.75 * max_speed < speed(body.truth) < max_speed


@pytest.mark.flight
def test_rover_stops():
    world, body = single_body(ROVER)
    body.fly_velocity(4, 0, 0)
    step_for(world, 6)
    assert speed(body.truth) > 3.5
    body.go_to(*body.estimate[:3])
    assert step_for(world, 10, lambda: speed(body.truth) < 0.05) < 6
    body.fly_velocity(4, 0, 0)
    step_for(world, 6)
    body.stop()
    step_for(world, 8)
    assert speed(body.truth) < 0.05


def test_sticks_drive_both_ways():
    world, body = single_body(ROVER)
    body.sticks(0, 0, -0.5, 0)
    step_for(world, 3)
    assert body.truth.velocity_east < -1
    body.sticks(0.8, 0, 0.4, 0)
    step_for(world, 1)
    assert body.truth.yaw_rate > 1
    assert body.servos[0] != body.servos[2]


def test_attitude_gives_heading_and_throttle():
    world, body = single_body(ROVER)
    body.hold_attitude(0, 0, 0.0, 0.3)
    step_for(world, 6)
    assert absolute_angle(body.truth.yaw) < 0.1
    assert body.truth.velocity_north > 1
    body.hold_rates(0, 0, 0.7, 0.0)
    step_for(world, 2)
    assert abs(body.truth.yaw_rate - 0.7) < 0.1


@pytest.mark.flight
def test_wheels_do_not_slip_but_a_hull_drifts_with_the_wind():
    rovers, rover = single_body(ROVER, wind=8.0)
    boats, boat = single_body(BOAT, wind=8.0)
    step_for(rovers, 20)
    step_for(boats, 20)
    assert horizontal_distance(rover.truth, 0, 0) < 0.01
    assert 0.5 < boat.truth.east < 15


@pytest.mark.flight
def test_surface_vehicles_ignore_altitude(pair):
    world, bodies = pair
    for body in bodies:
        body.go_to(30, 20, -15, start=(0, 0, -15))
    step_for(world, 35)
    for body, bound in zip(bodies, (1.6, 3.2), strict=True):
        assert horizontal_distance(body.truth, 30, 20) < bound


@pytest.mark.fast_cases(1)
def test_speed_stays_near_the_demand_while_accelerating(pair):
    world, bodies = pair
    for body in bodies:
        body.go_to(60, 0, 0, speed=2.4)
    for motions in record_all(world, bodies, 15):
        assert 2.2 < max(speed(m) for m in motions) < 2.8
