"""Betaflight's packets."""

from __future__ import annotations

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.rotation import from_euler, rotate
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.betaflight import BetaflightInterface, encode_sticks
from mavstack.simulators.sensor_model import SensorModel, SensorModels
from mavstack.simulators.sensors import Sensors
from mavstack.simulators.state import State

SILENT = SensorModels.ideal()


def interface(**options):
    return BetaflightInterface(Sensors(DEFAULT_HOME, models=SILENT), DEFAULT_HOME, **options)


def product(a, b):
    """Return the product of two quaternions."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def received(packet):
    """Return attitude (north, west, up), gyroscope, accelerometer and place as Betaflight computes them."""
    values = struct.unpack("<18d", packet)
    k = math.sqrt(0.5)
    w, x, y, z = values[7], values[8], -values[9], -values[10]
    attitude = product((k, 0.0, 0.0, k), (w, x, y, z))
    gyroscope = (values[1], -values[2], values[3])
    accelerometer = tuple(-value for value in values[4:7])
    place = (2 * DEFAULT_HOME.latitude - values[15], 2 * DEFAULT_HOME.longitude - values[14])
    return attitude, gyroscope, accelerometer, place, values


def test_the_default_build_gets_what_it_expects():
    heading, nose = math.radians(40), math.radians(20)
    state = State(
        (100.0, 0.0, -50.0),
        (3.0, 4.0, -1.0),
        from_euler(0.0, nose, heading),
        (0.1, 0.2, 0.3),
        (9.80665 * math.sin(nose), 0.0, -9.80665 * math.cos(nose)),
    )
    attitude, gyroscope, accelerometer, place, values = received(interface().step(state, 1.0))
    forward = rotate(attitude, (1.0, 0.0, 0.0))
    assert forward == pytest.approx(
        (math.cos(nose) * math.cos(heading), -math.cos(nose) * math.sin(heading), math.sin(nose))
    )
    # Betaflight's pitch is positive for nose down.
    assert gyroscope == pytest.approx((0.1, -0.2, -0.3))
    # The accelerometer is the specific force in forward, left, up.
    assert accelerometer == pytest.approx((state.specific_force[0], 0.0, 9.80665 * math.cos(nose)))
    assert place[0] == pytest.approx(DEFAULT_HOME.latitude + 100.0 / 111_200, abs=2e-5)
    assert place[1] == pytest.approx(DEFAULT_HOME.longitude)
    assert values[11:14] == pytest.approx((4.0, 3.0, 1.0))
    assert values[0] == 1.0
    assert values[17] == pytest.approx(95_000, rel=0.01)


def test_the_clock_of_a_packet_can_differ_from_the_time_of_the_simulation():
    assert struct.unpack("<18d", interface().step(State(), 3.0, clock=0.5))[0] == 0.5


def test_builds_for_other_simulators_get_true_values():
    values = struct.unpack("<18d", interface(bridge="legacy").step(State(rates=(0.1, 0.2, 0.3)), 0.0))
    assert values[1:4] == pytest.approx((0.1, 0.2, 0.3))
    assert values[7:11] == pytest.approx((1.0, 0.0, 0.0, 0.0))
    assert values[15] == pytest.approx(DEFAULT_HOME.latitude)


def test_a_lost_position_is_no_position():
    made = interface()
    made._sensors.faults.inject("gps-lost")
    values = struct.unpack("<18d", made.step(State(), 0.0))
    assert values[14:16] == (999.0, 999.0)


def test_motors_get_the_order_of_the_body():
    made = interface()
    assert made.feed(struct.pack("<4f", 0.1, 0.2, 0.3, 0.4))  # rear right, front right, rear left, front left
    assert made.controls == pytest.approx((0.2, 0.3, 0.4, 0.1))
    older = interface(motors="gazebo")
    older.feed(struct.pack("<4f", 0.1, 0.2, 0.3, 1.4))
    assert older.controls == pytest.approx((0.1, 0.2, 0.3, 1.0))


@pytest.mark.parametrize("data", [b"", b"0" * 15, b"0" * 17, struct.pack("<4f", 0.0, math.nan, 0.0, 0.0)])
def test_other_packets_are_counted(data):
    made = interface()
    assert not made.feed(data)
    assert (made.answers, made.invalid) == (0, 1)


@pytest.mark.properties
@given(st.binary(max_size=20))
def test_any_bytes_are_taken(data):
    made = interface()
    made.feed(data)
    assert all(0.0 <= value <= 1.0 for value in made.controls)


def test_sticks():
    data = encode_sticks([1500, 1500, 1000, 1500, 2000], 2.5)
    assert struct.unpack("<d16H", data) == (2.5, 1500, 1500, 1000, 1500, 2000, *[1000] * 11)
    for wrong in ([1500] * 17, [-1]):
        with pytest.raises(InvalidArgumentError, match="the sticks must be up to 16 channels"):
            encode_sticks(wrong, 0.0)


def test_wrong_options_are_refused():
    with pytest.raises(InvalidArgumentError, match="there is no bridge 'x'"):
        interface(bridge="x")
    with pytest.raises(InvalidArgumentError, match="there is no motor order 'x'"):
        interface(motors="x")
    assert SILENT.gyroscope == SensorModel()
