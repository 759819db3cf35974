"""PX4's side of its HIL interface."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import Dialect, common
from mavstack.rotation import from_euler, to_euler
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.foreign.px4_side import Px4Side, SidePhase
from mavstack.simulators.px4 import Px4Interface
from mavstack.simulators.sensors import Sensors
from mavstack.simulators.state import State
from mavstack.wire import Parser, encode

DIALECT = Dialect.load("common")
NUMBERS = st.floats(width=32)


def sensor(time=1_000_000, bits=0x3F, **fields):
    values = {"zacc": -9.81} | fields
    return encode(common.HilSensor(time_usec=time, fields_updated=bits, **values), system=1, component=51)


def test_it_asks_for_the_true_state_and_sends_a_heartbeat():
    side = Px4Side(DIALECT)
    assert side.phase is SidePhase.CONNECTING
    command, heartbeat = (packet.message for packet in Parser(DIALECT).feed(side.connected()))
    assert (command.command, command.param1, command.param2) == (511, 115, 5000)
    assert heartbeat.autopilot == common.MavAutopilot.PX4
    assert side.phase is SidePhase.CONNECTED


def test_each_sensor_is_a_step_and_the_place_comes_with_gps():
    side = Px4Side(DIALECT)
    assert side.feed(sensor()) == [None]
    assert side.phase is SidePhase.NO_PLACE
    fix = common.HilGps(fix_type=3, lat=473977418, lon=85455939, alt=488000, vn=100)
    side.feed(encode(fix, system=1, component=51))
    (sample,) = side.feed(sensor(1_004_000, xgyro=0.5))
    assert side.phase is SidePhase.LOCKSTEP
    assert sample.time == pytest.approx(1.004)
    assert sample.position == pytest.approx((0.0, 0.0, 0.0), abs=0.1)
    assert sample.velocity[0] == pytest.approx(1.0, abs=0.05)
    assert sample.rates == pytest.approx((0.5, 0.0, 0.0))


def test_the_answer_is_in_lockstep():
    side = Px4Side(DIALECT)
    side.feed(sensor(1_008_000))
    (packet,) = Parser(DIALECT).feed(side.answer([0.5] * 4, is_armed=True))
    assert packet.message.controls == (0.5,) * 4 + (0.0,) * 12
    assert packet.message.time_usec == 1_008_000
    assert int(packet.message.mode) == 129
    assert packet.message.flags == 1


def test_an_estimate_from_sensors_follows_a_turned_body():
    world = Px4Interface(DIALECT, Sensors(DEFAULT_HOME))
    world.connected()
    side = Px4Side(DIALECT)
    leaning = State(attitude=from_euler(0.2, -0.1, 2.0), specific_force=(-0.98, -1.94, -9.56))
    samples = []
    for _ in range(1500):
        without_truth = b"".join(
            packet.raw
            for packet in Parser(DIALECT).feed(world.step(leaning))
            if not isinstance(packet.message, common.HilStateQuaternion)
        )
        samples += side.feed(without_truth)
    assert to_euler(samples[-1].attitude) == pytest.approx((0.2, -0.1, 2.0), abs=0.03)
    assert not side.problems


def test_problems_are_named():
    side = Px4Side(DIALECT)
    assert side.feed(sensor(bits=0x07)) == []
    side.feed(sensor(2_000_000))
    side.feed(sensor(1_000_000))
    wrong = common.HilStateQuaternion(attitude_quaternion=(2.0, 0.0, 0.0, 0.0))
    side.feed(encode(wrong, system=1, component=51))
    assert len(side.problems) == 3
    assert any("0x3f" in problem for problem in side.problems)


@pytest.mark.properties
@given(st.binary(max_size=300))
def test_any_bytes_are_taken(data):
    side = Px4Side(DIALECT)
    side.feed(data)
    assert side.feed(b"\0" * 300 + sensor()) == [None]


@pytest.mark.properties
@given(st.lists(st.tuples(st.integers(0, 2**63), NUMBERS, NUMBERS), max_size=10))
def test_any_values_are_taken(rows):
    side = Px4Side(DIALECT)
    for time, force, rate in rows:
        side.feed(sensor(time, xacc=force, xgyro=rate))
