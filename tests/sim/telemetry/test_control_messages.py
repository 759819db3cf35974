"""Messages about control, against the body's control loops."""

from __future__ import annotations

import pytest

from mavstack.rotation import from_euler
from mavstack.sim.telemetry.producers import Producers
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.telemetry.flight import Flight


def test_the_attitude_target_is_what_the_loops_ask_for():
    flying = Flight(VehicleType.COPTER, Firmware.PX4).fly()
    flying.body.hold_attitude(0.3, 0.0, None, 0.5)
    flying.run(0.1)
    setpoint = flying.body.attitude_setpoint
    message = Producers(flying.vehicle).control.attitude_target(flying.now)
    assert setpoint.roll == 0.3 != pytest.approx(flying.body.estimate.roll, abs=0.02)
    assert message.q == pytest.approx(from_euler(*setpoint[:3]), abs=1e-5)
    rates = message.body_roll_rate, message.body_pitch_rate, message.body_yaw_rate
    assert rates == pytest.approx(setpoint[3:], abs=1e-5)
