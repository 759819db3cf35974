"""ArduPilot's hardware in the loop."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import Dialect, common
from mavstack.rotation import from_euler
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.hil_state import HilStateInterface
from mavstack.simulators.outputs import Outputs
from mavstack.simulators.sensor_model import SensorModels
from mavstack.simulators.sensors import Sensors
from mavstack.simulators.state import State
from mavstack.wire import Parser, encode

DIALECT = Dialect.load("common")


def interface():
    return HilStateInterface(DIALECT, Sensors(DEFAULT_HOME, models=SensorModels.ideal()))


def test_a_state_has_the_units_of_the_message():
    state = State((0.0, 0.0, -10.0), (1.0, -2.0, 400.0), from_euler(0.1, 0.2, 0.3), (0.4, 0.5, 0.6))
    (packet,) = Parser(DIALECT).feed(interface().step(state, 1.5))
    message = packet.message
    assert isinstance(message, common.HilState)
    assert (message.roll, message.pitch, message.yaw) == pytest.approx((0.1, 0.2, 0.3))
    assert (message.vx, message.vy, message.vz) == (100, -200, 32767)
    assert (message.xacc, message.yacc, message.zacc) == (0, 0, -1000)
    assert message.alt == pytest.approx(498_000, abs=2)
    assert message.time_usec == 1_500_000


def test_outputs_become_actuators():
    made = interface()
    scaled = common.RcChannelsScaled(
        chan1_scaled=5000, chan2_scaled=-5000, chan3_scaled=10000, chan4_scaled=2500
    )
    assert made.feed(encode(scaled, system=1, component=1))
    assert made.actuators(Outputs.SURFACES) == (0.5, -0.5, 1.0, 0.25)
    assert made.actuators(Outputs.STEERING) == (0.5, 1.0)
    assert not made.feed(encode(common.Heartbeat(), system=1, component=1))


@pytest.mark.properties
@given(st.binary(max_size=200))
def test_any_bytes_are_taken(data):
    made = interface()
    made.feed(data)
    assert len(made.actuators(Outputs.SURFACES)) == 4
