from __future__ import annotations

from mavstack.sim.vehicle_types import VehicleType
from tests.sim.motion.flights import alone, apart, away, fly, speed, turned, watch


def diving(depth: float = 10.0):
    world, body = alone(VehicleType.SUB, wind=8.0)
    body.place(0, 0, depth, 0)
    body.go_to(0, 0, depth)
    fly(world, 5)
    return world, body


def test_dives_and_holds_its_depth():
    world, body = alone(VehicleType.SUB)
    body.go_to(0, 0, 8)
    fly(world, 28)
    assert all(abs(m.down - 8) < 0.6 for m in watch(world, body, 10))


def test_goes_to_a_point_and_holds_there():
    world, body = diving()
    body.go_to(10, -5, 12)
    fly(world, 25)
    seen = watch(world, body, 8)
    assert all(apart(m, (10, -5, 12)) < 1.2 for m in seen)
    assert all(turned(m.roll) < 0.1 and turned(m.pitch) < 0.1 for m in seen)


def test_circles():
    world, body = diving()
    body.circle(0, 0, 10, 5)
    fly(world, 20)
    assert all(abs(away(m, 0, 0) - 5) < 1.2 for m in watch(world, body, 15))


def test_is_no_faster_than_its_thrusters():
    world, body = diving()
    body.fly_velocity(50, 0, 0)
    fly(world, 10)
    assert 1.0 < speed(body.truth) < 1.8


def test_floats_up_when_stopped_and_stays_at_the_surface():
    world, body = diving(2.0)
    body.stop()
    fly(world, 20)
    assert body.truth.down == 0.0
    assert body.on_ground
    body.fly_velocity(0, 0, -1)
    fly(world, 2)
    assert body.truth.down == 0.0


def test_rests_on_the_bottom():
    world, body = diving(39.0)
    body.fly_velocity(0, 0, 0.5)
    fly(world, 6)
    assert body.truth.down == 40.0
    assert body.on_ground
    assert body.truth.velocity_down == 0.0


def test_sticks_and_attitudes():
    world, body = diving()
    body.sticks(0, 1.0, 0, 0)
    fly(world, 3)
    assert body.truth.velocity_north > 0.6
    body.sticks(0, 0, 1.0, 0)
    fly(world, 3)
    assert body.truth.velocity_down < -0.5
    body.hold_attitude(0.3, 0, 0, 0.5)
    fly(world, 4)
    assert abs(body.truth.roll - 0.3) < 0.06
    assert body.servos[0] > 0


def test_water_presses():
    world, body = diving(20.0)
    deep = body.sensors.pressure
    body.place(0, 0, 1.0, 0)
    assert 1500 < deep - body.sensors.pressure < 2200
    assert body.sensors.temperature > 0
    assert world.time > 0
