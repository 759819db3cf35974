"""PX4's HIL interface."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import Dialect, common
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.px4 import START, STEP, Phase, Px4Interface
from mavstack.simulators.sensors import Sensors
from mavstack.simulators.state import State
from mavstack.wire import Parser, encode

DIALECT = Dialect.load("common")


def interface(seed=1):
    made = Px4Interface(DIALECT, Sensors(DEFAULT_HOME, seed))
    made.connected()
    return made


def messages(data):
    return [packet.message for packet in Parser(DIALECT).feed(data)]


def controls(values=(0.5,) * 16, mode=129):
    return encode(
        common.HilActuatorControls(time_usec=1, controls=values, mode=mode, flags=1), system=1, component=1
    )


def test_it_waits_for_a_connection():
    made = Px4Interface(DIALECT, Sensors(DEFAULT_HOME))
    assert made.phase is Phase.WAITING
    made.connected()
    assert made.phase is Phase.CONNECTED
    assert "first HIL_SENSOR" in made.phase.value
    made.overdue()
    assert made.phase is Phase.CONNECTED
    made.step(State())
    assert made.phase is Phase.START_UP


def test_every_step_moves_the_clock_on():
    made = interface()
    times = [messages(made.step(State()))[0].time_usec for _ in range(50)]
    assert times == [START + STEP * index for index in range(50)]


def test_all_bits_of_each_sensor_are_set_together():
    made = interface()
    flags = [messages(made.step(State()))[0].fields_updated for _ in range(10)]
    assert [int(each) for each in flags] == [0x1FFF, 0x3F, 0x3F, 0x3F, 0x3F] * 2


def test_values_at_rest():
    sensor, fix, truth = messages(interface().step(State()))
    assert sensor.zacc == pytest.approx(-9.81, abs=0.2)
    assert sensor.abs_pressure == pytest.approx(956, abs=2)
    assert sensor.pressure_alt == pytest.approx(DEFAULT_HOME.altitude, abs=1)
    assert (sensor.xmag, sensor.ymag, sensor.zmag) == pytest.approx((0.215, 0.013, 0.432), abs=0.008)
    assert fix.fix_type == 3
    assert fix.lat == pytest.approx(DEFAULT_HOME.latitude * 1e7, abs=200)
    assert fix.cog == 65535
    assert truth.attitude_quaternion == pytest.approx((1, 0, 0, 0))


def test_no_two_samples_are_equal():
    made = interface()
    values = {messages(made.step(State()))[0].xacc for _ in range(100)}
    assert len(values) == 100


def test_positions_come_ten_times_a_second():
    made = interface()
    found = [
        message
        for _ in range(250)
        for message in messages(made.step(State()))
        if isinstance(message, common.HilGps)
    ]
    assert len(found) == 10


def test_controls_end_a_step_and_begin_the_lockstep():
    made = interface()
    made.step(State())
    assert made.feed(encode(common.Heartbeat(), system=1, component=1)) is False
    assert made.phase is Phase.START_UP
    data = controls()
    assert made.feed(data[:10]) is False
    assert made.feed(data[10:]) is True
    assert made.phase is Phase.LOCKSTEP
    assert made.is_armed
    assert made.controls == (0.5,) * 16


@pytest.mark.properties
@given(st.binary(max_size=400))
def test_any_bytes_are_taken(data):
    made = interface()
    made.feed(data)
    assert made.feed(b"\0" * 300 + controls()) is True


def test_faults_reach_the_messages():
    sensors = Sensors(DEFAULT_HOME)
    made = Px4Interface(DIALECT, sensors)
    for name in ("gps-lost", "imu-frozen", "barometer-blocked"):
        sensors.faults.inject(name)
    _, fix, _ = messages(made.step(State()))
    assert (fix.fix_type, fix.satellites_visible) == (0, 0)
    first = messages(made.step(State(rates=(1.0, 0.0, 0.0))))[0]
    assert first.xgyro == pytest.approx(0.0)


def test_an_answer_that_no_step_waited_for_is_counted():
    made = interface()
    made.step(State())
    made.feed(controls())
    assert made.extra_answers == 0
    made.feed(controls())
    assert (made.answers, made.extra_answers) == (2, 1)


def test_silence_is_a_phase_that_an_answer_ends():
    made = interface()
    made.step(State())
    made.feed(controls())
    made.step(State())
    made.overdue()
    assert made.phase is Phase.OVERDUE
    made.feed(controls())
    assert made.phase is Phase.LOCKSTEP
    made.closed()
    assert "start both again" in made.phase.value


def test_rangefinder_and_optical_flow():
    made = Px4Interface(DIALECT, Sensors(DEFAULT_HOME, equipment=["rangefinder", "optical-flow"]))
    made.connected()
    found = messages(made.step(State((0.0, 0.0, -4.0), (1.0, 0.0, 0.0))))
    distance = next(each for each in found if isinstance(each, common.DistanceSensor))
    flow = next(each for each in found if isinstance(each, common.HilOpticalFlow))
    assert distance.current_distance == pytest.approx(400, abs=15)
    assert distance.orientation == 25
    assert flow.integrated_y == pytest.approx(0.25 * 0.05, abs=0.005)
    assert flow.quality == 255
