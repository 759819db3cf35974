from __future__ import annotations

import pytest

from mavstack.sim.motion import World
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
