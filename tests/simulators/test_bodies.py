"""Own bodies, flown by outputs."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.rotation import to_euler
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.bodies.copter import Copter
from mavstack.simulators.bodies.plane import Plane
from mavstack.simulators.bodies.quadplane import QuadPlane
from mavstack.simulators.bodies.submarine import Submarine
from mavstack.simulators.bodies.surface import boat, rover
from mavstack.simulators.physics import PHYSICS, load_physics
from tests.simulators.flying import climb_out, hold_attitude

OWN = [name for name, entry in PHYSICS.items() if entry.example == name]


def run(body, actuators, seconds, dt=0.004):
    for _ in range(round(seconds / dt)):
        state = body.step(actuators, dt)
    return state


@pytest.mark.parametrize("name", OWN)
def test_a_body_at_rest_measures_gravity(name):
    body, _ = load_physics(name)
    for state in (
        body.reset(DEFAULT_HOME, 30.0),
        run(body, [0.0] * (4 if name in ("plane", "rover", "boat") else 16), 2),
    ):
        state.checked()
        assert state.position == pytest.approx((0.0, 0.0, 0.0), abs=0.02)
        assert state.specific_force == pytest.approx((0.0, 0.0, -9.80665), abs=0.15)
        assert math.degrees(to_euler(state.attitude)[2]) == pytest.approx(30.0, abs=1.0)


@pytest.mark.properties
@pytest.mark.parametrize("name", OWN)
@given(st.lists(st.lists(st.floats(-2, 2), min_size=6, max_size=6), min_size=1, max_size=30))
def test_any_outputs_give_a_valid_state_above_ground(name, steps):
    body, _ = load_physics(name)
    body.reset(DEFAULT_HOME, 0.0)
    for outputs in steps:
        state = run(body, outputs, 0.1, dt=0.01).checked()
        if name != "sub":
            assert state.position[2] <= 1e-9


def test_a_copter_hovers_at_half_of_its_thrust():
    copter = Copter()
    state = copter.reset(DEFAULT_HOME, 0.0)
    assert run(copter, [0.45] * 4, 2).position[2] == 0.0
    state = run(copter, [0.55] * 4, 3)
    assert state.position[2] < -2.0
    assert state.velocity[2] < 0.0


@pytest.mark.parametrize(
    ("motors", "axis", "sign"),
    [
        ((0.5, 0.6, 0.6, 0.5), 0, 1),  # the left ones are stronger: it rolls to the right
        ((0.6, 0.5, 0.6, 0.5), 1, 1),  # the front ones: its nose rises
        ((0.6, 0.6, 0.5, 0.5), 2, 1),  # those that turn counterclockwise: it turns clockwise
    ],
)
def test_motors_turn_a_copter(motors, axis, sign):
    copter = Copter()
    copter.reset(DEFAULT_HOME, 0.0)
    run(copter, [0.7] * 4, 0.5)
    rates = run(copter, motors, 0.1).rates
    assert rates[axis] * sign > 0.05
    assert all(abs(rate) < 1e-6 for index, rate in enumerate(rates) if index != axis)


def test_a_copter_flies_forward_with_its_nose_down_and_is_slowed_by_the_air():
    copter = Copter()
    state = copter.reset(DEFAULT_HOME, 90.0)
    for step in range(5000):
        state = copter.step(hold_attitude(state, 0.53, pitch=math.radians(-10) if step > 250 else 0.0), 0.004)
    assert 5.0 < state.velocity[1] < 12.0
    assert abs(state.velocity[0]) < 0.1


def test_wind_carries_a_copter():
    copter = Copter(wind=(0.0, 5.0, 0.0))
    state = copter.reset(DEFAULT_HOME, 0.0)
    for _ in range(5000):
        state = copter.step(hold_attitude(state, 0.51), 0.004)
    assert state.velocity[1] == pytest.approx(5.0, abs=1.0)


def test_a_copter_lands_and_stays():
    copter = Copter()
    state = copter.reset(DEFAULT_HOME, 0.0)
    for lift, seconds in ((0.6, 2), (0.42, 6), (0.0, 2)):
        for _ in range(round(seconds / 0.004)):
            state = copter.step(hold_attitude(state, lift), 0.004)
    assert state.position[2] == 0.0
    assert state.velocity == (0.0, 0.0, 0.0)


def test_a_plane_takes_off_from_its_wheels():
    plane = Plane()
    state = climb_out(plane, plane.reset(DEFAULT_HOME, 90.0), 12)
    assert state.position[2] < -10.0
    assert state.position[1] > 50.0
    assert 12.0 < state.airspeed < 25.0


def test_a_plane_turns_to_the_lower_wing():
    plane = Plane()
    state = climb_out(plane, plane.reset(DEFAULT_HOME, 0.0), 12)
    for _ in range(500):
        roll = to_euler(state.attitude)[0]
        state = plane.step((1.5 * (0.5 - roll) - 0.3 * state.rates[0], 0.15, 0.9, 0.0), 0.004)
    assert state.velocity[1] > 1.0


def test_a_plane_without_thrust_glides_down_and_stops():
    plane = Plane()
    state = climb_out(plane, plane.reset(DEFAULT_HOME, 0.0), 10)
    for _ in range(15000):
        roll, pitch, _ = to_euler(state.attitude)
        aileron = -1.5 * roll - 0.3 * state.rates[0]
        state = plane.step((aileron, -2.0 * pitch - 0.3 * state.rates[1], 0.0, 0.0), 0.004)
    assert state.position[2] == 0.0
    assert state.velocity == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("make", [rover, boat])
def test_steering_to_the_right(make):
    body = make()
    body.reset(DEFAULT_HOME, 0.0)
    state = run(body, (0.3, 0.4), 2)
    assert state.velocity[0] != 0.0
    assert state.rates[2] > 0.0
    assert state.position[1] > 0.0


def test_a_rover_does_not_turn_on_the_spot_and_a_boat_does():
    for make, turns in ((rover, False), (boat, True)):
        body = make()
        body.reset(DEFAULT_HOME, 0.0)
        assert (body.step((1.0, 0.2), 0.004).rates[2] > 0.05) is turns


@pytest.mark.parametrize(
    ("thrusters", "moved"),
    [
        ((-0.5, -0.5, 0.5, 0.5, 0.0, 0.0), (1, 0, 0)),
        ((0.5, -0.5, 0.5, -0.5, 0.0, 0.0), (0, 1, 0)),
        ((0.0, 0.0, 0.0, 0.0, 0.5, 0.5), (0, 0, 1)),
    ],
)
def test_thrusters_move_a_submarine(thrusters, moved):
    sub = Submarine()
    sub.reset(DEFAULT_HOME, 0.0)
    run(sub, (0.0, 0.0, 0.0, 0.0, 0.6, 0.6), 5)
    before = sub.step(thrusters, 0.004).velocity
    after = run(sub, thrusters, 3).velocity
    for axis, wanted in enumerate(moved):
        assert (after[axis] - (before[axis] if axis != 2 else 0.0) > 0.3) is bool(wanted)


def test_a_submarine_floats_up_and_stays_at_the_surface():
    sub = Submarine()
    sub.reset(DEFAULT_HOME, 0.0)
    assert run(sub, (0, 0, 0, 0, 0.6, 0.6), 4).position[2] > 1.0
    assert run(sub, [0.0] * 6, 60).position[2] == pytest.approx(0.0, abs=0.01)


def test_a_quadplane_rises_by_its_motors_and_flies_by_its_wing():
    quadplane = QuadPlane()
    state = quadplane.reset(DEFAULT_HOME, 0.0)
    for _ in range(1000):
        state = quadplane.step([0.0] * 4 + hold_attitude(state, 0.6), 0.004)
    assert state.position[2] < -5.0
    for _ in range(1500):  # the motors carry it until the wing does
        lift = max(0.0, 0.55 - 0.04 * state.airspeed)
        motors = hold_attitude(state, lift, pitch=0.05)
        state = quadplane.step([0.0, 0.1, 1.0, 0.0, *motors], 0.004).checked()
    assert state.airspeed > 13.0
    assert state.velocity[0] > 13.0
    assert state.position[2] < -5.0
