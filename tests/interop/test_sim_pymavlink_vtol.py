"""A pymavlink script flies a simulated quadplane like a real one: modes by name, arming unforced."""

from __future__ import annotations

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.interop.test_sim_pymavlink import ACCEPTED, script, send_command, set_mode, wait_for_altitude

pytestmark = pytest.mark.interop


def test_a_quadplane_takes_off_in_guided() -> None:
    with script("vtol") as (vehicle, connection):
        assert connection.mode_mapping()["GUIDED"] == 15
        set_mode(connection, "GUIDED")
        while not vehicle.autopilot.booted:
            connection.recv_match(blocking=True, timeout=0.1)
        assert send_command(connection, mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == ACCEPTED
        assert send_command(connection, mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 20) == ACCEPTED
        wait_for_altitude(connection, 20)
        set_mode(connection, "QLAND")
