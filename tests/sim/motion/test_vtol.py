from __future__ import annotations

import pytest

from mavstack.sim.vehicle_types import VehicleType
from tests.sim.motion.flights import (
    absolute_angle,
    distance_to,
    horizontal_distance,
    record,
    single_body,
    step_for,
)


def hovering(height: float = 50.0, *, wind: float = 0.0):
    world, body = single_body(VehicleType.VTOL, wind=wind)
    body.place(0, 0, -height, 0)
    body.go_to(0, 0, -height)
    step_for(world, 2)
    return world, body


@pytest.mark.flight
def test_hovers_and_goes_to_points_like_a_copter():
    world, body = hovering(wind=8.0)
    body.go_to(40, 0, -50)
    step_for(world, 20)
    assert all(distance_to(m, (40, 0, -50)) < 3.0 for m in record(world, body, 8))
    assert body.transition < 0.5
    assert not body.flies_forward


@pytest.mark.nightly
@pytest.mark.parametrize("wind", [0.0, 8.0])
def test_transitions_both_ways_and_keeps_its_altitude(wind):
    world, body = hovering(wind=wind)
    body.go_to(0, -2000, -50)
    body.transition_to(True)
    assert body.flies_forward
    motions = record(world, body, 18)
    assert body.transition == 1.0
    assert body.airspeed > 15
    assert all(abs(m.down + 50) < 4 for m in motions)
    assert all(abs(m.north) < 8 for m in motions)
    body.transition_to(False)
    here = body.estimate
    body.go_to(here.north, here.east, -50)
    motions = record(world, body, 34)
    assert body.transition == 0.0
    assert all(abs(m.down + 50) < 4 for m in motions)
    assert all(absolute_angle(m.roll) < 0.8 for m in motions)
    assert horizontal_distance(motions[-1], here.north, here.east) < 4


@pytest.mark.flight
def test_lift_motors_stop_in_forward_flight():
    world, body = hovering()
    body.go_to(3000, 0, -50)
    body.transition_to(True)
    step_for(world, 25)
    assert body.servos[4:8] == pytest.approx((1050,) * 4, abs=60)
    assert body.servos[2] > 1200


@pytest.mark.nightly
def test_circles_in_forward_flight():
    world, body = hovering()
    body.go_to(400, 0, -50)
    body.transition_to(True)
    step_for(world, 12)
    body.circle(400, 0, -60, 100)
    step_for(world, 30)
    assert all(
        abs(horizontal_distance(m, 400, 0) - 100) < 12 and abs(m.down + 60) < 5
        for m in record(world, body, 20)
    )


@pytest.mark.flight
def test_stays_in_hover_without_a_transition_demand():
    world, body = hovering()
    step_for(world, 5)
    assert body.transition == 0.0
