"""Offboard: entered with a setpoint stream only, and the failsafe when the stream ends."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services.setpoints import AttitudeSetpoint, LocalSetpoint
from tests.sim.px4.harness import RESULT, Px4Harness


def stream(harness: Px4Harness, setpoint: LocalSetpoint | AttitudeSetpoint, seconds: float) -> None:
    harness.run(
        seconds, lambda: harness.send(setpoint.to_message(harness.vehicle.address, harness.vehicle.uptime_ms))
    )


NORTHWARD = LocalSetpoint(velocity=(2.0, 0.0, 0.0))


@pytest.mark.flight
def test_offboard_needs_and_follows_a_setpoint_stream() -> None:
    harness = Px4Harness().take_off()
    assert harness.set_mode(6) == RESULT.TEMPORARILY_REJECTED
    stream(harness, NORTHWARD, 2.0)
    assert abs(harness.vehicle.body.truth.velocity_north) < 0.5  # setpoints are ignored outside Offboard
    assert harness.set_mode(6) == RESULT.ACCEPTED
    stream(harness, NORTHWARD, 5.0)
    assert harness.heartbeat[:2] == (0b10001, (6, 0))
    assert harness.vehicle.body.truth.velocity_north == pytest.approx(2, abs=0.3)


@pytest.mark.fast_cases(1)
@pytest.mark.flight_cases(3)
@pytest.mark.parametrize("vehicle_type", ["copter", "vtol", "rover", "boat", "sub", "plane"])
def test_one_recent_setpoint_admits_offboard(vehicle_type: str) -> None:
    harness = Px4Harness(vehicle_type)
    harness.arm()
    stream(harness, NORTHWARD, 0.1)
    assert harness.set_mode(6) == RESULT.ACCEPTED


@pytest.mark.flight
def test_an_old_setpoint_does_not_admit_offboard() -> None:
    harness = Px4Harness().take_off()
    for _ in range(5):
        stream(harness, NORTHWARD, 0.1)
        harness.run(1.2)
    assert harness.set_mode(6) == RESULT.TEMPORARILY_REJECTED


@pytest.mark.flight
def test_without_a_position_offboard_takes_attitudes_only() -> None:
    harness = Px4Harness().take_off(30)
    harness.vehicle.faults.inject("gps off")
    harness.run(10.0)
    stream(harness, NORTHWARD, 0.5)
    assert harness.set_mode(6) == RESULT.TEMPORARILY_REJECTED
    stream(harness, AttitudeSetpoint(attitude=(1.0, 0.0, 0.0, 0.0), thrust=0.52), 0.5)
    assert harness.set_mode(6) == RESULT.ACCEPTED


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize(
    ("action", "mode"),
    [(0, "Return"), (1, "Return"), (2, "Return"), (3, "Return"), (4, "Land"), (5, "Hold")],
)
def test_com_obl_rc_act_when_the_stream_ends(action: int, mode: str) -> None:
    harness = Px4Harness().take_off()
    harness.vehicle.parameters.set("COM_OBL_RC_ACT", action)
    stream(harness, NORTHWARD, 1.0)
    harness.set_mode(6)
    stream(harness, NORTHWARD, 2.0)
    harness.run(0.6)
    assert harness.mode == "Offboard"
    harness.run(2.0)
    assert harness.mode == mode
    assert "Failsafe activated" in harness.texts
    assert harness.heartbeat[2] == common.MavState.CRITICAL
    harness.set_mode(4, 3)
    harness.set_mode(4, 5)
    harness.run(1.5)
    assert harness.heartbeat[2] == common.MavState.ACTIVE


@pytest.mark.flight
def test_com_of_loss_t_delays_the_failsafe() -> None:
    harness = Px4Harness().take_off()
    harness.vehicle.parameters.set("COM_OF_LOSS_T", 4.0)
    stream(harness, NORTHWARD, 1.0)
    harness.set_mode(6)
    stream(harness, NORTHWARD, 1.0)
    harness.run(3.5)
    assert harness.mode == "Offboard"
    harness.run(1.5)
    assert harness.mode == "Return"


@pytest.mark.flight
def test_arming_and_takeoff_in_offboard() -> None:
    harness = Px4Harness()
    up = LocalSetpoint(position=(5.0, 0.0, -8.0), yaw=0.0)
    stream(harness, up, 1.0)
    assert harness.set_mode(6) == RESULT.ACCEPTED
    stream(harness, up, 0.4)
    harness.arm()
    stream(harness, up, 12.0)
    assert harness.height == pytest.approx(8, abs=1)
    assert harness.vehicle.body.truth.north == pytest.approx(5, abs=1)


def test_unsupported_frames_are_ignored() -> None:
    harness = Px4Harness().take_off()
    frd = LocalSetpoint(velocity=(2.0, 0.0, 0.0), frame=common.MavFrame.BODY_FRD)
    stream(harness, frd, 1.0)
    assert harness.set_mode(6) == RESULT.TEMPORARILY_REJECTED


@pytest.mark.flight
def test_attitude_setpoint() -> None:
    harness = Px4Harness().take_off(30)
    lean = AttitudeSetpoint(attitude=(0.9962, 0.0872, 0.0, 0.0), thrust=0.52)
    stream(harness, lean, 1.0)
    assert harness.set_mode(6) == RESULT.ACCEPTED
    stream(harness, lean, 2.0)
    assert harness.vehicle.body.truth.roll == pytest.approx(0.1745, abs=0.05)
