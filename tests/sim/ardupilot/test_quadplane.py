"""A quadplane as ground stations see it: a plane by its heartbeat, with lifting motors by its parameters."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from tests.sim.ardupilot.harness import CMD, ArdupilotHarness
from tests.sim.harness import RESULT

PLANE, QUADPLANE = common.MavType.FIXED_WING, common.MavType.VTOL_FIXEDROTOR


def last_heartbeat(harness: ArdupilotHarness) -> common.Heartbeat:
    return harness.received_of(common.Heartbeat)[-1]


def test_quadplane_calls_itself_a_plane_unless_a_parameter_names_its_type() -> None:
    harness = ArdupilotHarness("vtol")
    assert last_heartbeat(harness).type == PLANE
    harness.vehicle.parameters.set("Q_MAV_TYPE", int(QUADPLANE))
    harness.run(1.5)
    assert last_heartbeat(harness).type == QUADPLANE
    harness.vehicle.reboot()
    harness.run(4.0)
    assert last_heartbeat(harness).type == QUADPLANE


@pytest.mark.parametrize(("vehicle_type", "state"), [("vtol", "MC"), ("plane", "UNDEFINED")])
def test_extended_state_shows_which_plane_hovers(vehicle_type: str, state: str) -> None:
    harness = ArdupilotHarness(vehicle_type)
    message_id = common.ExtendedSysState.__mavlink_row__[0]
    assert harness.command(CMD.REQUEST_MESSAGE, message_id) == RESULT.ACCEPTED
    assert harness.received_of(common.ExtendedSysState)[-1].vtol_state == common.MavVtolState[state]


def test_quadplane_takes_off_in_guided_and_flies_its_mission_without_forced_arming() -> None:
    harness = ArdupilotHarness("vtol")
    assert harness.set_mode("GUIDED") == RESULT.ACCEPTED
    harness.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    harness.accepted(CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 20)
    harness.run_until(lambda: harness.autopilot.altitude > 19)
    assert harness.set_mode("AUTO") == RESULT.ACCEPTED
