"""Offboard: entered only with a stream, followed only in it, and what comes when the stream ends."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services.setpoints import AttitudeSetpoint, LocalSetpoint
from tests.sim.px4.pilot import RESULT, Pilot


def stream(pilot: Pilot, setpoint: LocalSetpoint | AttitudeSetpoint, seconds: float) -> None:
    pilot.run(
        seconds, lambda: pilot.send(setpoint.to_message(pilot.vehicle.address, pilot.vehicle.uptime_ms))
    )


NORTHWARD = LocalSetpoint(velocity=(2.0, 0.0, 0.0))


def test_it_is_entered_with_a_stream_and_follows_it() -> None:
    pilot = Pilot().in_the_air()
    assert pilot.set_mode(6) == RESULT.TEMPORARILY_REJECTED
    stream(pilot, NORTHWARD, 2.0)
    assert abs(pilot.vehicle.body.truth.velocity_north) < 0.5  # not before it is in Offboard
    assert pilot.set_mode(6) == RESULT.ACCEPTED
    stream(pilot, NORTHWARD, 5.0)
    assert pilot.heartbeat[:2] == (0b10001, (6, 0))
    assert pilot.vehicle.body.truth.velocity_north == pytest.approx(2, abs=0.3)


def test_a_slow_stream_is_none() -> None:
    pilot = Pilot().in_the_air()
    for _ in range(5):
        stream(pilot, NORTHWARD, 0.1)
        pilot.run(1.2)
    assert pilot.set_mode(6) == RESULT.TEMPORARILY_REJECTED


@pytest.mark.parametrize(
    ("action", "mode"),
    [(0, "Return"), (1, "Return"), (2, "Return"), (3, "Return"), (4, "Land"), (5, "Hold")],
)
def test_when_the_stream_ends_it_does_as_com_obl_rc_act_says(action: int, mode: str) -> None:
    pilot = Pilot().in_the_air()
    pilot.vehicle.parameters.set("COM_OBL_RC_ACT", action)
    stream(pilot, NORTHWARD, 1.0)
    pilot.set_mode(6)
    stream(pilot, NORTHWARD, 2.0)
    pilot.run(0.6)
    assert pilot.mode == "Offboard"
    pilot.run(2.0)
    assert pilot.mode == mode
    assert "Failsafe activated" in pilot.texts
    assert pilot.heartbeat[2] == common.MavState.CRITICAL
    pilot.set_mode(4, 3)
    pilot.set_mode(4, 5)
    pilot.run(1.5)
    assert pilot.heartbeat[2] == common.MavState.ACTIVE


def test_patience_is_com_of_loss_t() -> None:
    pilot = Pilot().in_the_air()
    pilot.vehicle.parameters.set("COM_OF_LOSS_T", 4.0)
    stream(pilot, NORTHWARD, 1.0)
    pilot.set_mode(6)
    stream(pilot, NORTHWARD, 1.0)
    pilot.run(3.5)
    assert pilot.mode == "Offboard"
    pilot.run(1.5)
    assert pilot.mode == "Return"


def test_motors_may_be_armed_in_it_and_a_position_lifts_off() -> None:
    pilot = Pilot()
    up = LocalSetpoint(position=(5.0, 0.0, -8.0), yaw=0.0)
    stream(pilot, up, 1.0)
    assert pilot.set_mode(6) == RESULT.ACCEPTED
    stream(pilot, up, 0.4)
    pilot.arm()
    stream(pilot, up, 12.0)
    assert pilot.height == pytest.approx(8, abs=1)
    assert pilot.vehicle.body.truth.north == pytest.approx(5, abs=1)


def test_frames_that_px4_does_not_take_are_no_setpoints() -> None:
    pilot = Pilot().in_the_air()
    frd = LocalSetpoint(velocity=(2.0, 0.0, 0.0), frame=common.MavFrame.BODY_FRD)
    stream(pilot, frd, 1.0)
    assert pilot.set_mode(6) == RESULT.TEMPORARILY_REJECTED


def test_an_attitude_is_followed() -> None:
    pilot = Pilot().in_the_air(30)
    lean = AttitudeSetpoint(attitude=(0.9962, 0.0872, 0.0, 0.0), thrust=0.52)
    stream(pilot, lean, 1.0)
    assert pilot.set_mode(6) == RESULT.ACCEPTED
    stream(pilot, lean, 2.0)
    assert pilot.vehicle.body.truth.roll == pytest.approx(0.1745, abs=0.05)
