from __future__ import annotations

import math

import pytest

from mavstack.sim.vehicle_types import VehicleType
from tests.sim.motion.flights import (
    HOME,
    absolute_angle,
    distance_to,
    horizontal_distance,
    record,
    record_all,
    several_bodies,
    single_body,
    speed,
    step_for,
)


def hovering(height: float = 20.0, *, wind: float = 0.0):
    world, body = single_body(VehicleType.COPTER, wind=wind)
    body.place(0, 0, -height, 0)
    body.go_to(0, 0, -height)
    step_for(world, 2)
    return world, body


def test_takes_off_and_climbs_at_the_demanded_rate():
    world, body = single_body(VehicleType.COPTER)
    assert body.on_ground
    body.go_to(0, 0, -20, climb=3.0)
    motions = record(world, body, 15)
    assert not body.on_ground
    assert -3.4 < min(m.velocity_down for m in motions) < -2.7
    assert abs(motions[-1].down + 20) < 0.6
    assert max(horizontal_distance(m, 0, 0) for m in motions) < 1.0


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("wind", [0.0, 8.0])
def test_goes_to_a_point_and_holds_there(wind):
    world, body = hovering(wind=wind)
    body.go_to(80, -40, -30, speed=8)
    motions = record(world, body, 26)
    assert max(math.hypot(m.velocity_north, m.velocity_east) for m in motions) < 9.5
    assert max(absolute_angle(m.roll) for m in motions) < 0.7
    held = record(world, body, 6)
    assert max(distance_to(m, (80, -40, -30)) for m in held) < 1.6
    assert max(speed(m) for m in held) < 1.2


@pytest.mark.flight
def test_follows_the_line_in_wind():
    world, body = hovering(wind=8.0)
    body.go_to(100, 0, -20, speed=8)
    assert max(abs(m.east) for m in record(world, body, 20)) < 2.0


@pytest.mark.flight
def test_joins_a_parallel_line():
    world, body = hovering()
    body.go_to(100, 20, -20, start=(0, 20, -20), speed=6)
    motions = record(world, body, 25)
    assert abs(motions[500].east - 20) < 1.0
    assert distance_to(motions[-1], (100, 20, -20)) < 1.5


@pytest.mark.flight
def test_circles_in_both_directions():
    world, bodies = several_bodies(VehicleType.COPTER, 2, wind=8.0)
    for body, radius in zip(bodies, (15, -15), strict=True):
        body.place(0, 0, -20, 0)
        body.circle(0, 0, -20, radius, speed=4)
    step_for(world, 15)
    for motions, direction in zip(record_all(world, bodies, 15), (1, -1), strict=True):
        assert all(abs(horizontal_distance(m, 0, 0) - 15) < 1.8 for m in motions)
        assert all(direction * (m.north * m.velocity_east - m.east * m.velocity_north) > 0 for m in motions)
        assert all(absolute_angle(math.atan2(-m.east, -m.north) - m.yaw) < 0.3 for m in motions)


def test_flies_a_velocity_and_keeps_its_heading():
    world, body = hovering()
    body.fly_velocity(0, 5, -1, yaw=1.0)
    step_for(world, 6)
    motions = record(world, body, 4)
    assert all(abs(m.velocity_east - 5) < 0.6 and abs(m.velocity_down + 1) < 0.4 for m in motions)
    assert all(absolute_angle(m.yaw - 1.0) < 0.08 for m in motions)


def test_turns_at_a_yaw_rate():
    world, body = hovering()
    body.fly_velocity(0, 0, 0, yaw_rate=0.5)
    step_for(world, 1)
    assert all(abs(m.yaw_rate - 0.5) < 0.1 for m in record(world, body, 3))


def test_heading_follows_a_long_line_and_stays_on_a_short_one():
    world, body = hovering()
    body.go_to(0, 50, -20)
    step_for(world, 3)
    assert absolute_angle(body.truth.yaw - math.pi / 2) < 0.1
    body.go_to(*body.estimate[:2], -30)
    step_for(world, 3)
    assert absolute_angle(body.truth.yaw - math.pi / 2) < 0.1


def test_holds_an_attitude():
    world, body = hovering(50)
    body.hold_attitude(0.2, -0.1, 0.5, 0.5)
    step_for(world, 2)
    assert absolute_angle(body.truth.roll - 0.2) < 0.05
    assert absolute_angle(body.truth.pitch + 0.1) < 0.05
    assert absolute_angle(body.truth.yaw - 0.5) < 0.1


def test_half_thrust_hovers_and_full_thrust_climbs():
    world, body = hovering(50)
    body.hold_attitude(0, 0, 0, 0.5)
    step_for(world, 2)
    assert abs(body.truth.velocity_down) < 2.5
    body.hold_attitude(0, 0, 0, 1.0)
    step_for(world, 2)
    assert body.truth.velocity_down < -6


def test_flips_through_the_vertical():
    world, body = hovering(80)
    body.hold_rates(0, 3.0, 0, 0.3)
    pitches = record(world, body, 2.5)
    assert max(m.pitch for m in pitches) > 1.4
    assert any(absolute_angle(m.roll) > 2.5 for m in pitches)
    body.go_to(0, 0, -40)
    step_for(world, 4)
    assert absolute_angle(body.truth.roll) < 0.7


def test_sticks_tilt_the_copter():
    world, body = hovering(50)
    body.sticks(1.0, 0, 0.55, 0)
    step_for(world, 1)
    assert abs(body.truth.roll - body.limits.tilt) < 0.06
    body.sticks(0, 0, 0.5, 1.0)
    step_for(world, 1)
    assert body.truth.yaw_rate > 1.0


@pytest.mark.flight
def test_lands_at_a_sink_rate_and_falls_when_stopped():
    world, body = hovering(5)
    body.fly_velocity(0, 0, 1.0)
    assert step_for(world, 12, lambda: body.on_ground) < 8
    body.stop()
    step_for(world, 0.5)
    assert body.throttle < 0.01
    body.place(0, 0, -30, 0)
    step_for(world, 2)
    assert body.truth.velocity_down > 10
    step_for(world, 3)
    assert body.on_ground
    assert speed(body.truth) == 0.0


@pytest.mark.flight
def test_limits_bound_the_speed():
    world, body = hovering()
    body.set_limit("speed", 3.0)
    body.go_to(100, 0, -20)
    step_for(world, 4)
    assert 2.4 < body.truth.velocity_north < 3.5
    body.set_limit("speed", 6.0)
    step_for(world, 4)
    assert 5.2 < body.truth.velocity_north < 6.8
    assert body.limits.speed == 6.0


def test_starts_at_home():
    _, body = single_body(VehicleType.COPTER)
    assert body.truth[:3] == (0, 0, 0)
    assert absolute_angle(body.truth.yaw - math.radians(HOME.heading)) < 1e-9
    assert body.frame.to_global(0, 0, 0) == pytest.approx(HOME[:3])


@pytest.mark.flight
def test_joins_a_line_that_begins_ahead_within_the_demanded_speed():
    world, body = hovering()
    body.go_to(40, 0, -20, start=(15, 0, -20), speed=4)
    assert max(speed(m) for m in record(world, body, 8)) < 4.4
