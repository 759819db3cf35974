"""ArduPilot's side of its JSON interface."""

from __future__ import annotations

import json
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.rotation import to_euler
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.ardupilot import JsonInterface, ServoOutputs
from mavstack.simulators.bodies.copter import Copter
from mavstack.simulators.foreign.json_side import JsonSide
from mavstack.simulators.outputs import Outputs
from mavstack.simulators.sensors import Sensors

GOOD = {
    "timestamp": 1.0,
    "imu": {"gyro": [0.1, 0, 0], "accel_body": [0, 0, -9.81]},
    "position": [1, 2, -3],
    "velocity": [4, 5, 6],
    "attitude": [0.1, 0.2, 0.3],
}


def line(values):
    return b"\n" + json.dumps(values, separators=(",", ":")).encode() + b"\n"


def test_questions_are_numbered_and_repeated():
    side = JsonSide(400)
    first, second = side.ask([1000] * 4), side.ask([1500] * 20)
    assert ServoOutputs.parse(first) == ServoOutputs(400, 0, (1000,) * 4 + (0,) * 12)
    assert ServoOutputs.parse(second).number == 1
    assert len(ServoOutputs.parse(second).pulses) == 32
    assert side.repeat() == second


def test_an_answer_is_a_sample():
    side = JsonSide()
    assert "waits for the first answer" in side.status
    sample = side.feed(line(GOOD))
    assert sample.position == (1.0, 2.0, -3.0)
    assert to_euler(sample.attitude) == pytest.approx((0.1, 0.2, 0.3))
    quaternion = side.feed(line(GOOD | {"quaternion": [0.0, 1.0, 0.0, 0.0]}))
    assert quaternion.attitude == (0.0, 1.0, 0.0, 0.0)
    assert side.steps == 2


def test_our_own_world_is_understood():
    world = JsonInterface(Copter(), Outputs.MOTORS, DEFAULT_HOME, Sensors(DEFAULT_HOME))
    side = JsonSide()
    assert side.feed(world.answer(side.ask([1000] * 4))) is not None
    assert not side.problems


@pytest.mark.parametrize(
    ("data", "problem"),
    [
        (json.dumps(GOOD).encode(), "has spaces after a name"),
        (b"{", "is not JSON"),
        (b"[]", "not the right number"),
        (line({k: v for k, v in GOOD.items() if k != "velocity"}), "has no velocity"),
        (line({k: v for k, v in GOOD.items() if k != "attitude"}), "has no attitude or quaternion"),
        (line(GOOD | {"imu": {"gyro": [0, 0, 0]}}), "has no imu.accel_body"),
        (line(GOOD | {"position": [1, 2]}), "not the right number"),
        (line(GOOD | {"position": [1, 2, float("nan")]}), "not the right number"),
        (line(GOOD | {"quaternion": [2.0, 0.0, 0.0, 0.0]}), "not the right number"),
    ],
)
def test_answers_that_ardupilot_does_not_accept(data, problem):
    side = JsonSide()
    assert side.feed(data) is None
    assert problem in side.status
    assert side.steps == 0


def test_a_time_that_goes_back_is_named():
    side = JsonSide()
    side.feed(line(GOOD))
    side.feed(line(GOOD | {"timestamp": 0.5}))
    assert side.problems == {"the timestamp went back"}


@pytest.mark.properties
@given(st.binary(max_size=200))
def test_any_bytes_are_taken(data):
    JsonSide().feed(data)


@pytest.mark.properties
@given(
    st.recursive(
        st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
        lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(sorted(GOOD)), inner),
        max_leaves=12,
    )
)
def test_any_json_is_taken(value):
    JsonSide().feed(line(value))


def test_a_question_is_what_the_world_parses():
    assert struct.unpack_from("<H", JsonSide().ask([1000] * 32)) == (29569,)
