from __future__ import annotations

import math

import pytest

from mavstack.sim.vehicle_types import VehicleType
from tests.sim.motion.flights import (
    absolute_angle,
    horizontal_distance,
    record,
    record_all,
    several_bodies,
    single_body,
    speed,
    step_for,
)


def cruising(height: float = 80.0, *, wind: float = 0.0):
    world, body = single_body(VehicleType.PLANE, wind=wind)
    body.place(0, 0, -height, 0)
    body.fly_velocity(18, 0, 0)
    step_for(world, 5)
    return world, body


@pytest.mark.flight
def test_takes_off_from_the_ground():
    world, body = single_body(VehicleType.PLANE)
    body.go_to(0, 600, -60)
    motions = record(world, body, 40)
    assert not body.on_ground
    assert motions[-1].down < -50
    assert max(abs(m.north) for m in motions) < 5


@pytest.mark.nightly
@pytest.mark.flight
def test_follows_a_line_with_its_slope_and_flies_on():
    world, body = cruising(wind=8.0)
    start = (body.truth.north, body.truth.east + 30, -80.0)
    body.go_to(start[0] + 500, start[1], -110, start=start)
    step_for(world, 18)
    motions = record(world, body, 25)
    assert all(abs(m.east - start[1]) < 4 for m in motions)
    slope = [-80 - 30 * min((m.north - start[0]) / 500, 1.0) for m in motions]
    assert all(abs(m.down - height) < 4 for m, height in zip(motions, slope, strict=True))
    assert motions[-1].north > start[0] + 520


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("wind", [0.0, 8.0])
def test_circles_in_both_directions(wind):
    world, bodies = several_bodies(VehicleType.PLANE, 2, wind=wind)
    for body, radius in zip(bodies, (80, -80), strict=True):
        body.place(0, 0, -85, 0)
        body.circle(0, 100, -90, radius)
    step_for(world, 25)
    for motions, direction in zip(record_all(world, bodies, 25), (1, -1), strict=True):
        assert all(abs(horizontal_distance(m, 0, 100) - 80) < 8 for m in motions)
        assert all(abs(m.down + 90) < 4 for m in motions)
        assert all(
            direction * (m.north * m.velocity_east - (m.east - 100) * m.velocity_north) > 0 for m in motions
        )


@pytest.mark.flight
def test_keeps_its_airspeed_and_bank():
    world, body = cruising(wind=8.0)
    body.circle(0, 0, -80, 60)
    speeds = []
    for _ in range(1000):
        world.step()
        speeds.append(body.airspeed)
        assert absolute_angle(body.truth.roll) < body.limits.tilt + 0.1
    assert 14 < min(speeds) < max(speeds) < 23


@pytest.mark.flight
def test_velocity_sets_course_airspeed_and_climb():
    world, body = cruising()
    body.fly_velocity(0, 15, -2)
    step_for(world, 10)
    motions = record(world, body, 5)
    assert all(
        absolute_angle(math.atan2(m.velocity_east, m.velocity_north) - math.pi / 2) < 0.1 for m in motions
    )
    assert all(abs(m.velocity_down + 2) < 0.8 for m in motions)
    assert abs(body.airspeed - 15) < 1.5


@pytest.mark.nightly
@pytest.mark.flight
def test_stalls_when_held_nose_up_without_power_and_recovers():
    world, body = cruising(200)
    body.hold_attitude(0, 0.5, None, 0.0, yaw_rate=0.0)
    motions, slowest = [], 99.0
    for _ in range(400):
        world.step()
        motions.append(body.truth)
        slowest = min(slowest, body.airspeed)
    assert slowest < 10.5
    assert max(m.velocity_down for m in motions) > 4
    assert min(m.pitch for m in motions) < 0.0
    body.fly_velocity(18, 0, 0)
    step_for(world, 8)
    assert abs(body.truth.velocity_down) < 1.5
    assert body.airspeed > 15


@pytest.mark.nightly
@pytest.mark.flight
def test_glides_without_its_motor():
    world, body = cruising(200)
    body.fail_motor(1, True)
    body.go_to(5000, 0, -200)
    step_for(world, 10)
    motions = record(world, body, 20)
    assert body.throttle < 0.01
    assert body.airspeed > 10.5
    sunk = motions[-1].down - motions[0].down
    assert 6 < (motions[-1].north - motions[0].north) / sunk < 16
    assert max(m.velocity_down for m in motions) < 4


@pytest.mark.flight
def test_lands_and_rolls_out():
    world, body = cruising(30)
    body.fly_velocity(15, 0, 1.5)
    step_for(world, 30, lambda: body.on_ground)
    assert body.on_ground
    body.roll_out()
    assert step_for(world, 20, lambda: speed(body.truth) < 0.01) < 10
    assert body.throttle < 0.01
    assert absolute_angle(body.truth.roll) < 0.02
    step_for(world, 5)
    assert speed(body.truth) < 0.01


@pytest.mark.flight
def test_sticks_move_the_surfaces():
    world, body = cruising(200)
    body.sticks(0.5, 0, 0.4, 0)
    step_for(world, 1)
    assert body.truth.roll > 0.3
    assert body.servos[0] > 1500
    world, body = cruising(200)
    body.hold_rates(-0.5, 0, 0, 0.4)
    step_for(world, 1)
    assert body.truth.roll_rate < -0.3


@pytest.mark.flight
def test_stays_on_the_ground_in_wind():
    world, body = single_body(VehicleType.PLANE, wind=8.0)
    body.idle()
    step_for(world, 8)
    assert horizontal_distance(body.truth, 0, 0) < 1.0


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("limit", [0.0, 9.0, 100.0])
def test_no_airspeed_limit_makes_it_stall(limit):
    world, body = cruising()
    for name in ("airspeed_min", "airspeed_cruise", "speed", "airspeed_max"):
        body.set_limit(name, limit)
    body.circle(0, 0, -90, 60, speed=limit)
    slowest = 99.0
    for _ in range(1000):
        world.step()
        slowest = min(slowest, body.airspeed)
    assert slowest > 10.5
    assert abs(body.truth.down + 90) < 5


@pytest.mark.flight
def test_wheels_hold_the_heading_in_a_cross_wind():
    world, body = single_body(VehicleType.PLANE, wind=6.0)
    body.place(0, 0, 0, 0)  # to the north, the wind comes from the west
    step_for(world, 10)
    assert absolute_angle(body.truth.yaw) < 0.1
    body.hold_attitude(0.0, 0.0, 0.0, 1.0)
    step_for(world, 10, until=lambda: body.airspeed > 12)
    assert absolute_angle(body.truth.yaw) < 0.15
    assert abs(body.truth.east) < 2
