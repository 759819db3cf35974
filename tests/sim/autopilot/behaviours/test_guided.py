"""The guided behaviours: streams of setpoints, and offboard mode."""

from __future__ import annotations

import pytest

from mavstack.services.setpoints import LocalSetpoint
from mavstack.sim.autopilot.behaviours import Offboard
from tests.sim.autopilot.harness import HOLD, AutopilotHarness
from tests.sim.autopilot.setpoints import guided, send_setpoint, stream


def offboard(flight: AutopilotHarness) -> None:
    flight.fly(Offboard)


@pytest.mark.flight
def test_a_stream_lives_from_its_first_setpoint_until_the_newest_is_too_old() -> None:
    flight = guided(setpoint_timeout=1.0)
    target = flight.autopilot.guided
    assert not target.stream_alive
    send_setpoint(flight, LocalSetpoint(velocity=(0.0, 0.0, 0.0)))
    assert target.stream_alive
    flight.run(0.9)
    assert target.stream_alive
    flight.run(0.3)
    assert not target.stream_alive
    send_setpoint(flight, LocalSetpoint(velocity=(0.0, 0.0, 0.0)))
    assert target.stream_alive


@pytest.mark.flight
def test_offboard_takes_off_by_a_position_and_follows() -> None:
    flight = AutopilotHarness(setpoint_timeout=1.0)
    stream(flight, LocalSetpoint(position=(0.0, 0.0, -5.0)), 1.0)
    flight.arm()
    offboard(flight)
    stream(flight, LocalSetpoint(position=(0.0, 0.0, -5.0)), 10.0)
    assert flight.height == pytest.approx(5.0, abs=1.0)
    stream(flight, LocalSetpoint(position=(5.0, 5.0, -5.0), yaw=1.0), 10.0)
    assert flight.distance((5.0, 5.0)) < 1.0


@pytest.mark.flight
def test_offboard_that_starves_does_what_the_firmware_does() -> None:
    flight = AutopilotHarness(setpoint_timeout=1.0).in_the_air(10.0)
    stream(flight, LocalSetpoint(velocity=(2.0, 0.0, 0.0)), 1.0)
    offboard(flight)
    stream(flight, LocalSetpoint(velocity=(2.0, 0.0, 0.0)), 3.0)
    assert flight.speed > 1.5
    flight.run(0.8)
    assert flight.autopilot.mode.number != HOLD
    flight.run(1.0)
    assert flight.autopilot.mode.number == HOLD
    flight.run(5)
    assert flight.speed < 0.5


def test_offboard_without_a_stream_ends_at_once() -> None:
    flight = AutopilotHarness().in_the_air(10.0)
    offboard(flight)
    flight.run(0.5)
    assert flight.autopilot.mode.number == HOLD
