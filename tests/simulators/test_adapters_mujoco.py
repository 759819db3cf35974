"""Models of MuJoCo."""

from __future__ import annotations

import math

import pytest

from mavstack.errors import InvalidArgumentError, MissingExtraError
from mavstack.rotation import from_euler, to_euler
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.physics import load_physics
from tests.simulators.flying import hold_attitude
from tests.simulators.quadrotor import QUADROTOR

pytest.importorskip("mujoco")
pytestmark = [pytest.mark.interop]


@pytest.fixture
def quadrotor(tmp_path):
    file = tmp_path / "quad.xml"
    file.write_text(QUADROTOR)
    return load_physics(f"mujoco:{file}")[0]


@pytest.mark.smoke
def test_a_quadrotor_stands_rises_and_leans(quadrotor):
    state = quadrotor.reset(DEFAULT_HOME, 90.0).checked()
    assert math.degrees(to_euler(state.attitude)[2]) == pytest.approx(90.0)
    for _ in range(500):
        state = quadrotor.step([0.0] * 4, 0.004)
    assert state.specific_force == pytest.approx((0.0, 0.0, -9.81), abs=0.1)
    for _ in range(500):
        state = quadrotor.step(hold_attitude(state, 0.6), 0.004).checked()
    assert state.position[2] < -2.0
    for _ in range(500):
        state = quadrotor.step(hold_attitude(state, 0.55, roll=0.2), 0.004).checked()
    assert to_euler(state.attitude)[0] == pytest.approx(0.2, abs=0.05)
    assert state.velocity[0] < -1.0  # it looks east, so that its right is south


def test_yaw_follows_the_outer_motors(quadrotor):
    quadrotor.reset(DEFAULT_HOME, 0.0)
    for _ in range(250):
        state = quadrotor.step([0.65, 0.65, 0.55, 0.55], 0.004)
    assert state.rates[2] > 0.1  # counterclockwise motors push it clockwise
    assert state.attitude != from_euler(0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        (None, "there is no such file"),
        ("<mujoco", "cannot be made: "),
        ("<mujoco/>", "its first joint must be a free joint"),
    ],
)
def test_wrong_models_are_reported(tmp_path, text, problem):
    file = tmp_path / "model.xml"
    if text is not None:
        file.write_text(text)
    with pytest.raises(InvalidArgumentError, match=problem):
        load_physics(f"mujoco:{file}")


def test_a_missing_program_is_named(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "mujoco", None)
    with pytest.raises(MissingExtraError, match=r"mavstack\[simulators\]"):
        load_physics("mujoco:quad.xml")
