"""Bodies at rest: their motion is not computed until a demand, a wind or a new position moves them."""

from __future__ import annotations

import pytest

from mavstack.sim.motion import World, rest
from mavstack.sim.motion import world as world_module
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.motion.flights import HOME, step_for


@pytest.fixture
def moves(monkeypatch) -> list[float]:
    """The times of the steps whose motion was computed."""
    times: list[float] = []
    move = World._move

    def counted(self: World, step: float) -> None:
        times.append(self.time)
        move(self, step)

    monkeypatch.setattr(world_module.World, "_move", counted)
    return times


@pytest.mark.parametrize("vehicle_type", VehicleType)
def test_the_motion_of_resting_bodies_is_not_computed(moves, vehicle_type):
    world = World()
    body = world.add(vehicle_type, HOME)
    start = body.truth[:3]
    step_for(world, 20)
    assert len(moves) < 10
    assert body.truth[:3] == start
    assert body.truth[3:] == (0.0,) * 8 + (body.truth.yaw,) + (0.0,) * 3


def test_estimate_and_battery_go_on_at_rest(moves):
    world = World()
    body = world.add(VehicleType.COPTER, HOME)
    step_for(world, 5)
    before, consumed = body.estimate, body.battery.consumed
    step_for(world, 5)
    assert len(moves) < 10
    assert body.estimate != before
    assert body.battery.consumed > consumed


def test_demand_wind_and_position_end_the_rest(moves):
    world = World()
    body = world.add(VehicleType.COPTER, HOME)
    step_for(world, 1)
    rested = len(moves)
    body.go_to(0, 0, -10)
    step_for(world, 10)
    assert len(moves) == rested + 500
    assert body.truth.down == pytest.approx(-10, abs=1)
    body.stop()
    step_for(world, 20)
    assert body.truth.down == 0
    assert len(moves) < rested + 1500
    count = len(moves)
    world.set_wind(5)
    step_for(world, 1)
    assert len(moves) == count + 50
    world.set_wind(0)
    step_for(world, 1)
    count = len(moves)
    body.place(0, 0, -5, 0)
    step_for(world, 2)
    assert len(moves) > count
    assert body.truth.down == 0


#: A row of the state, and the value of the second body that keeps all bodies from resting.
MOVING = {
    "velocity": 2 * rest.STILL_SPEED,
    "rates": 2 * rest.STILL_RATE,
    "attitude": 2 * rest.STILL_ANGLE,
    "lift_thrust": 2 * rest.STILL_THRUST,
    "drive_thrust": -2 * rest.STILL_THRUST,
    "transition": 0.1,
    "on_ground": False,
    "mode": 1,
}


@pytest.mark.parametrize("name", [None, *MOVING])
def test_all_bodies_must_be_still_in_each_quantity(name):
    world = World()
    for vehicle_type in (VehicleType.COPTER, VehicleType.VTOL):
        world.add(vehicle_type, HOME)
    step_for(world, 1)
    assert rest.come_to_rest(world.state)
    if name is not None:
        values = getattr(world.state, name)
        values[..., 1] = MOVING[name]
        assert not rest.come_to_rest(world.state), name
        assert (values[..., 1] == MOVING[name]).all()
