"""Item 0 of ArduPilot's mission: home, which DroneKit reads from a vehicle without a mission."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from tests.sim.ardupilot.harness import ArdupilotHarness

TARGET = {"target_system": 1, "target_component": 1}


def test_home_is_read_from_a_vehicle_without_a_mission() -> None:
    harness = ArdupilotHarness("copter")
    harness.run_until(lambda: harness.autopilot.home is not None)
    harness.send(common.MissionRequestList(**TARGET))
    harness.run(0.3)
    assert harness.received_of(common.MissionCount)[-1].count == 0
    harness.send(common.MissionRequest(seq=0, **TARGET))
    harness.run(0.3)
    item = harness.received_of(common.MissionItem)[-1]
    assert (item.x, item.y, item.z) == pytest.approx(harness.autopilot.home[:3], abs=1e-4)
    assert not harness.received_of(common.MissionAck)
