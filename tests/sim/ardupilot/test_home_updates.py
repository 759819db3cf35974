"""Home of a disarmed ArduPilot follows the vehicle, and a client that connects late gets it."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from tests.sim.ardupilot.harness import ArdupilotHarness


@pytest.mark.parametrize(("vehicle_type", "count"), [("plane", 4), ("vtol", 4), ("copter", 0), ("sub", 0)])
def test_home_is_broadcast_every_five_seconds_by_planes_alone(vehicle_type: str, count: int) -> None:
    harness = ArdupilotHarness(vehicle_type)
    harness.run(3)
    harness.received.clear()
    harness.run(20)
    assert len(harness.received_of(common.HomePosition)) == count


def test_a_rover_that_is_carried_half_a_metre_sets_home_again() -> None:
    harness = ArdupilotHarness("rover")
    harness.run(3)
    harness.vehicle.body.place(30.0, 0.0, 0.0, 0.0)
    harness.run(8)
    assert harness.autopilot.home_position[0] > 20.0


def test_home_that_was_set_by_command_stays() -> None:
    harness = ArdupilotHarness("plane")
    harness.accepted(common.MavCmd.DO_SET_HOME, 0, 0, 0, 0, 47.4, 8.55, 500)
    before = harness.autopilot.home
    harness.run(20)
    assert harness.autopilot.home == before


def test_an_armed_plane_keeps_its_home() -> None:
    harness = ArdupilotHarness("plane")
    harness.autopilot.arm(force=True)
    before = harness.autopilot.home
    harness.run(20)
    assert harness.autopilot.home == before
