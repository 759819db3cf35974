"""The capabilities of a vehicle: by firmware and flags, by components and messages, and what is unknown."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.sim.vehicle_types import VehicleType
from mavstack.vehicle import CalibrationKind
from tests.vehicle.peers import AUTOPILOT, TYPE, run_scenario
from tests.vehicle.world import ARDUPILOT, PX4, fly


@pytest.mark.parametrize("firmware", [ARDUPILOT, PX4])
def test_firmwares(firmware):
    async def scenario(world, vehicle):
        ardupilot = firmware is ARDUPILOT
        before = vehicle.capabilities
        assert (before.parameters, before.shell, before.servos) == (True, not ardupilot, ardupilot)
        assert before.ftp is None
        await vehicle.get_version()
        known = vehicle.capabilities
        assert (known.ftp, known.mavlink2, known.setpoints, known.termination) == (True,) * 4
        assert known.fence is not None
        assert known.flashing is False  # it is no board
        assert known.vtol is False
        assert CalibrationKind.COMPASS in known.calibrations
        assert {"ftp", "calibrations"} <= set(known.names)
        assert "vtol" not in known.names

    fly((VehicleType.COPTER, firmware), scenario)


def test_a_parameter_enables_equipment():
    async def scenario(world, vehicle):
        assert vehicle.capabilities.gripper is None
        await vehicle.params.get("GRIP_ENABLE")
        assert vehicle.capabilities.gripper is False
        await vehicle.params.set("GRIP_ENABLE", 1)
        assert vehicle.capabilities.gripper is True

    fly((VehicleType.COPTER, ARDUPILOT), scenario)


def test_components_and_messages_of_an_unknown_firmware():
    async def scenario(harness):
        await harness.add_peer(1, 1, autopilot=AUTOPILOT.GENERIC)
        await harness.add_peer(1, 100, type=TYPE.CAMERA, autopilot=AUTOPILOT.INVALID)
        await harness.add_peer(1, 154, type=TYPE.GIMBAL, autopilot=AUTOPILOT.INVALID)
        vehicle = await harness.connection.wait_for_vehicle(1)
        await vehicle.wait_for_message(common.Heartbeat)
        found = vehicle.capabilities
        assert (found.cameras, found.gimbals, found.calibrations) == ((100,), (154,), ())
        assert found.extended_parameters is True
        assert (found.shell, found.logs, found.parameters, found.mission) == (None,) * 4
        harness.peers[0].node.send(common.LogEntry(id=1))
        flags = common.MavProtocolCapability.PARAM_FLOAT | common.MavProtocolCapability.MISSION_RALLY
        harness.peers[0].node.send(common.AutopilotVersion(capabilities=flags))
        await vehicle.wait_for_message(common.Heartbeat)
        found = vehicle.capabilities
        assert (found.logs, found.parameters, found.rally, found.fence) == (True, True, True, False)

    run_scenario(scenario)
