"""Physics by name, and of users."""

from __future__ import annotations

import sys

import pytest

from mavstack.errors import InvalidArgumentError, MissingExtraError
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.outputs import Outputs
from mavstack.simulators.physics import PHYSICS, load_physics, vehicle_of
from mavstack.simulators.state import State

BALLOON = """
from mavstack.simulators import State

class Balloon:
    def reset(self, home, heading):
        self.height = 0.0
        return State()

    def step(self, actuators, dt):
        self.height += actuators[0] * dt
        return State(position=(0.0, 0.0, -self.height))

class Nothing:
    pass
"""


@pytest.fixture
def balloon(tmp_path, monkeypatch):
    (tmp_path / "balloon_of_a_user.py").write_text(BALLOON)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    yield "balloon_of_a_user"
    sys.modules.pop("balloon_of_a_user", None)


def test_a_class_of_the_working_folder(balloon):
    physics, outputs = load_physics(f"{balloon}:Balloon")
    assert outputs is Outputs.MOTORS
    physics.reset(DEFAULT_HOME, 0.0)
    assert physics.step((1.0,), 0.5).position == (0.0, 0.0, -0.5)


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("balloon", "there is no physics 'balloon': copter, plane, "),
        ("no_such_module:Balloon", "cannot be made: No module named"),
        (
            "balloon_of_a_user:Airship",
            "cannot be made: module 'balloon_of_a_user' has no attribute 'Airship'",
        ),
        ("balloon_of_a_user:Nothing", "has no reset and no step"),
        ("jsbsim", "needs a model: jsbsim:MODEL"),
    ],
)
def test_what_cannot_be_made(balloon, name, problem):
    with pytest.raises(InvalidArgumentError, match=problem):
        load_physics(name)


def test_a_missing_program_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "jsbsim", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'mavstack\[simulators\]'"):
        load_physics("jsbsim:c172x")


@pytest.mark.parametrize(
    ("physics", "vehicle"),
    [
        (None, "copter"),
        ("jsbsim:c172x", "plane"),
        ("boat", "boat"),
        ("vtol", "vtol"),
        ("own:Class", "copter"),
    ],
)
def test_the_vehicle_follows_the_physics(physics, vehicle):
    assert vehicle_of(physics) == vehicle


def test_every_entry_names_itself():
    for name, entry in PHYSICS.items():
        assert entry.example.partition(":")[0] == name


@pytest.mark.parametrize(
    "state",
    [
        State(position=(float("nan"), 0.0, 0.0)),
        State(attitude=(2.0, 0.0, 0.0, 0.0)),
        State(rates=(0.0, 0.0)),
    ],
)
def test_a_wrong_state_is_reported(state):
    with pytest.raises(InvalidArgumentError, match="the physics returned"):
        state.checked()


def test_outputs():
    pulses = (1100, 1900, 1000, 1500, *[0] * 12)
    assert Outputs.MOTORS.of_pulses(pulses)[:4] == pytest.approx((0.1, 0.9, 0.0, 0.5))
    assert Outputs.MOTORS.of_pulses(pulses)[5] == 0.0
    assert Outputs.SURFACES.of_pulses(pulses) == pytest.approx((-0.8, 0.8, 0.0, 0.0))
    assert Outputs.STEERING.of_pulses(pulses) == pytest.approx((-0.8, -1.0))
    assert Outputs.THRUSTERS.of_pulses(pulses)[:2] == pytest.approx((-1.0, 1.0))
    controls = (0.2, float("nan"), 0.4, 0.5, *[0.0] * 12)
    assert Outputs.MOTORS.of_controls(controls)[:3] == (0.2, 0.0, 0.4)
    assert Outputs.SURFACES.of_controls(controls) == (0.2, 0.0, 0.4, 0.5)
    assert Outputs.STEERING.of_controls(controls) == (0.2, 0.0)
    vtol = (1000, 2000, 1500, 1500, 1100, 1200, 1300, 1400, *[0] * 8)
    assert Outputs.VTOL.of_pulses(vtol) == pytest.approx((-1.0, 1.0, 0.5, 0.0, 0.1, 0.2, 0.3, 0.4))
    motors = (0.1, 0.2, 0.3, 0.4, 0.5, -1.0, 1.0, 0.25, *[0.0] * 8)
    assert Outputs.VTOL.of_controls(motors) == (-1.0, 1.0, 0.5, 0.25, 0.1, 0.2, 0.3, 0.4)
