"""The capabilities of a vehicle: by firmware and flags, by components and messages, and what is unknown."""

from __future__ import annotations

import asyncio
import re
from operator import attrgetter

import pytest

from mavstack.dialects import common
from mavstack.sim.vehicle_types import VehicleType
from mavstack.vehicle import CalibrationKind
from mavstack.vehicle.capabilities import Capabilities
from tests.vehicle.peers import AUTOPILOT, TYPE, run_scenario
from tests.vehicle.world import ARDUPILOT, PX4, fly


@pytest.mark.parametrize("firmware", [ARDUPILOT, PX4])
def test_firmwares(firmware):
    async def scenario(world, vehicle):
        ardupilot = firmware is ARDUPILOT
        before = vehicle.capabilities
        assert (before.parameters, before.shell, before.servos) == (True, not ardupilot, ardupilot)
        assert before.failures is not ardupilot
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
        await vehicle.wait_for_message(common.Heartbeat)
        await asyncio.sleep(3)
        assert vehicle.capabilities.events is not ardupilot

    fly((VehicleType.COPTER, firmware), scenario)


@pytest.mark.parametrize(
    ("firmware", "vehicle_type", "actions"),
    [
        (ARDUPILOT, VehicleType.COPTER, (True, True, True, True)),
        (ARDUPILOT, VehicleType.ROVER, (False, True, False, True)),
        (PX4, VehicleType.COPTER, (True, True, True, True)),
    ],
)
def test_actions(firmware, vehicle_type, actions):
    async def scenario(world, vehicle):
        found = vehicle.capabilities
        assert (found.takeoff, found.goto, found.orbit, found.manual_control) == actions
        assert (found.roi, found.home) == (True, True)

    fly((vehicle_type, firmware), scenario)


@pytest.mark.parametrize(("name", "parameter"), [("gripper", "GRIP_ENABLE"), ("winch", "WINCH_TYPE")])
def test_a_parameter_enables_equipment(name, parameter):
    async def scenario(world, vehicle):
        assert getattr(vehicle.capabilities, name) is None
        await vehicle.params.get(parameter)
        assert getattr(vehicle.capabilities, name) is False
        await vehicle.params.set(parameter, 1)
        assert getattr(vehicle.capabilities, name) is True

    fly((VehicleType.COPTER, ARDUPILOT), scenario)


def test_a_parameter_of_another_program_shows_a_display():
    async def scenario(harness):
        await harness.add_peer(1, 1)
        vehicle = await harness.connection.wait_for_vehicle(1)
        assert vehicle.capabilities.osd is None
        for value in (0.0, 1.0):
            kind = common.MavParamType.REAL32
            harness.peers[0].node.send(
                common.ParamValue(param_id="OSD_TYPE", param_value=value, param_type=kind, param_index=65535)
            )
            await vehicle.wait_for_message(common.Heartbeat)
            assert vehicle.capabilities.osd is bool(value)

    run_scenario(scenario)


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
        assert (found.events, found.winch) == (None, None)
        assert (found.takeoff, found.goto, found.orbit, found.manual_control) == (None,) * 4
        assert (found.roi, found.home) == (None, None)
        for message in (common.LogEntry(id=1), common.CurrentEventSequence(), common.WinchStatus()):
            harness.peers[0].node.send(message)
        flags = common.MavProtocolCapability.PARAM_FLOAT | common.MavProtocolCapability.MISSION_RALLY
        harness.peers[0].node.send(common.AutopilotVersion(capabilities=flags))
        await vehicle.wait_for_message(common.Heartbeat)
        found = vehicle.capabilities
        assert (found.logs, found.parameters, found.rally, found.fence) == (True, True, True, False)
        assert (found.events, found.winch) == (True, True)

    run_scenario(scenario)


def test_an_autopilot_manages_a_gimbal_once_it_reports_its_control():
    async def scenario(harness):
        await harness.add_peer(1, 1)
        vehicle = await harness.connection.wait_for_vehicle(1)
        assert vehicle.capabilities.gimbals == ()
        harness.peers[0].node.send(common.GimbalManagerStatus(gimbal_device_id=1))
        await vehicle.wait_for_message(common.Heartbeat)
        assert vehicle.capabilities.gimbals == (1,)

    run_scenario(scenario)


def test_only_a_build_with_its_parameters_has_sources_of_the_estimator():
    async def scenario(world, vehicle):
        assert vehicle.capabilities.ekf_sources is None
        await vehicle.params.get("EK3_SRC1_POSXY")
        assert vehicle.capabilities.ekf_sources is True

    fly((VehicleType.COPTER, ARDUPILOT), scenario)


def test_each_capability_names_the_call_behind_it():
    async def scenario(world, vehicle):
        documented = dict(re.findall(r"^ {8}(\w+): (.*)", Capabilities.__doc__ or "", re.MULTILINE))
        assert set(documented) == set(Capabilities.__slots__)
        calls = {name: re.search(r": `([\w.]+)`", text) for name, text in documented.items()}
        for call in filter(None, calls.values()):
            assert attrgetter(call[1])(vehicle) is not None, call[0]
        # These are about the settings of a flight controller and about its board.
        assert {name for name, call in calls.items() if call is None} == {"osd", "vtx", "flashing"}

    fly((VehicleType.COPTER, PX4), scenario, payloads=True)
