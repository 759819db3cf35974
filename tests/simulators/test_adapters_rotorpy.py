"""Quadrotors of rotorpy."""

from __future__ import annotations

import math

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.rotation import to_euler
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.physics import load_physics
from tests.simulators.flying import hold_attitude

pytest.importorskip("rotorpy")
pytestmark = [pytest.mark.interop]


@pytest.mark.smoke
def test_a_quadrotor_rises_and_leans():
    quadrotor, _ = load_physics("rotorpy:px4_sihsim_quadx")
    state = quadrotor.reset(DEFAULT_HOME, 90.0).checked()
    assert math.degrees(to_euler(state.attitude)[2]) == pytest.approx(90.0)
    for _ in range(50):
        state = quadrotor.step([0.1] * 4, 0.004).checked()
    assert state.position[2] == pytest.approx(0.0, abs=0.01)
    assert state.specific_force == pytest.approx((0.0, 0.0, -9.8), abs=0.1)
    for _ in range(300):
        state = quadrotor.step(hold_attitude(state, 0.6), 0.004).checked()
    assert state.position[2] < -0.5
    for _ in range(300):
        state = quadrotor.step(hold_attitude(state, 0.55, pitch=-0.2), 0.004).checked()
    assert to_euler(state.attitude)[1] == pytest.approx(-0.2, abs=0.05)
    assert state.velocity[1] > 0.5  # it looks east, and leans forward


@pytest.mark.parametrize("model", ["crazyflie", "hummingbird"])
def test_motors_turn_as_firmwares_expect(model):
    quadrotor, _ = load_physics(f"rotorpy:{model}")
    quadrotor.reset(DEFAULT_HOME, 0.0)
    for _ in range(150):
        state = quadrotor.step([0.9, 0.9, 0.7, 0.7], 0.004).checked()
    assert state.position[2] < 0.0
    assert state.rates[2] > 0.05
    assert state.rates[:2] == pytest.approx((0.0, 0.0), abs=0.1)


def test_unknown_parameters_are_reported():
    with pytest.raises(InvalidArgumentError, match="rotorpy has no parameters of 'zeppelin'"):
        load_physics("rotorpy:zeppelin")
