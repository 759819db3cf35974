from __future__ import annotations

import pytest

from mavstack.sim.vehicle_types import VehicleType
from tests.sim.motion.flights import single_body, step_for


@pytest.mark.flight
def test_hover_current_voltage_and_consumption():
    world, body = single_body(VehicleType.COPTER)
    full = body.battery
    assert full.voltage == pytest.approx(16.8)
    assert (full.cells, full.capacity, full.remaining) == (4, 5200, 1.0)
    body.place(0, 0, -20, 0)
    body.go_to(0, 0, -20)
    step_for(world, 30)
    after = body.battery
    assert 8 < after.current < 16
    assert 15.5 < after.voltage < 16.7
    assert after.consumed == pytest.approx(after.current * 30 / 3.6, rel=0.15)
    assert after.remaining == pytest.approx(1 - after.consumed / 5200)
    assert after.temperature > full.temperature


@pytest.mark.flight
def test_climbing_draws_more_than_hovering_and_stopped_almost_nothing():
    world, body = single_body(VehicleType.COPTER)
    step_for(world, 1)
    assert body.battery.current < 1
    body.go_to(0, 0, -100, climb=6)
    step_for(world, 4)
    climbing = body.battery
    body.go_to(*body.estimate[:3])
    step_for(world, 6)
    assert climbing.current > body.battery.current
    assert climbing.voltage < body.battery.voltage


@pytest.mark.flight
def test_empty_battery_makes_the_copter_land():
    world, body = single_body(VehicleType.COPTER)
    body.place(0, 0, -20, 0)
    body.go_to(0, 0, -20)
    step_for(world, 3)
    body.recharge(0.004)
    step_for(world, 25)
    assert body.battery.remaining < 0.003
    assert body.on_ground
    body.recharge()
    assert body.battery.remaining == 1.0
    body.go_to(0, 0, -10)
    step_for(world, 10)
    assert body.truth.down < -8
