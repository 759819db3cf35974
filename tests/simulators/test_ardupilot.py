"""ArduPilot's JSON interface."""

from __future__ import annotations

import json
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.ardupilot import JsonInterface, ServoOutputs
from mavstack.simulators.bodies.copter import Copter
from mavstack.simulators.outputs import Outputs
from mavstack.simulators.sensor_model import SensorModels
from mavstack.simulators.sensors import Sensors

IDEAL = SensorModels.ideal()


def datagram(number, pulses=(1000,) * 16, rate=400):
    magic = 18458 if len(pulses) == 16 else 29569
    return struct.pack(f"<HHI{len(pulses)}H", magic, rate, number, *pulses)


def interface(models=IDEAL, restarts=None):
    sensors = Sensors(DEFAULT_HOME, models=models)
    started = (lambda: restarts.append(1)) if restarts is not None else (lambda: None)
    return JsonInterface(Copter(), Outputs.MOTORS, DEFAULT_HOME, sensors, started)


def test_sixteen_and_thirty_two_outputs():
    assert ServoOutputs.parse(datagram(7)) == ServoOutputs(400, 7, (1000,) * 16)
    assert ServoOutputs.parse(datagram(7, (1500,) * 32)) == ServoOutputs(400, 7, (1500,) * 32)


@pytest.mark.parametrize(
    "data",
    [b"", b"\x1a", datagram(1)[:-1], datagram(1) + b"0", struct.pack("<HHI16H", 18458, 0, 1, *[0] * 16)],
)
def test_other_datagrams_are_counted_and_not_answered(data):
    made = interface()
    assert made.answer(data) is None
    assert (made.invalid, made.steps) == (1, 0)


@pytest.mark.properties
@given(st.binary(max_size=100))
def test_any_bytes_are_taken(data):
    interface().answer(data)


def test_the_answer_is_a_line_without_spaces():
    answer = interface().answer(datagram(0))
    assert answer.startswith(b"\n{")
    assert answer.endswith(b"}\n")
    assert b" " not in answer
    values = json.loads(answer)
    assert values["timestamp"] == pytest.approx(1 / 400)
    assert values["imu"]["accel_body"] == pytest.approx([0, 0, -9.80665])
    assert len(values["quaternion"]) == 4
    assert values["velocity"] == [0, 0, 0]
    assert values["position"] == [0, 0, 0]


def test_each_number_is_one_step_and_a_repeated_one_the_same_answer():
    made = interface(SensorModels())
    first = made.answer(datagram(0))
    second = made.answer(datagram(1))
    assert made.answer(datagram(1)) == second != first
    assert (made.steps, made.repeated) == (2, 1)
    assert made.time == pytest.approx(2 / 400)


def test_motors_lift_it():
    made = interface()
    for number in range(800):
        made.answer(datagram(number, (1600,) * 4 + (0,) * 12))
    assert made.state.position[2] < -1.0


def test_a_number_that_falls_back_is_a_restart():
    restarts = []
    made = interface(restarts=restarts)
    for number in range(400):
        made.answer(datagram(number, (1700,) * 16))
    assert restarts == [1]
    made.answer(datagram(0))
    assert restarts == [1, 1]
    assert made.time == pytest.approx(1 / 400)
    assert made.state.position == (0.0, 0.0, 0.0)


def test_a_slow_rate_is_a_step_that_sitl_takes():
    made = interface()
    made.answer(datagram(0, rate=1))
    assert made.time == pytest.approx(0.1)


def test_the_same_seed_gives_the_same_answers():
    def answers(seed):
        made = JsonInterface(Copter(), Outputs.MOTORS, DEFAULT_HOME, Sensors(DEFAULT_HOME, seed))
        return [made.answer(datagram(number, (1600,) * 16)) for number in range(100)]

    assert answers(3) == answers(3) != answers(4)
