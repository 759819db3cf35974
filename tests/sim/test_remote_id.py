"""The simulated Remote ID module, and the arming checks of both firmwares."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services.remote_id import Operator, RemoteIdSender
from mavstack.sim.simulation import Simulation
from tests.services.network import GROUND
from tests.services.single_service import sent_by
from tests.sim.harness import SimulationHarness, VehicleHarness

CHECKS = {
    "ardupilot": ({"DID_ENABLE": 1, "DID_OPTIONS": 1}, "OpenDroneID: "),
    "px4": ({"COM_ARM_ODID": 2}, "Preflight Fail: Open Drone ID system "),
}


def problems(vehicle) -> list[str]:
    from mavstack.sim.ardupilot.arming import prearm_problems
    from mavstack.sim.px4.arming import preflight_problems

    check = preflight_problems if vehicle.firmware == "px4" else prearm_problems
    return [text for text in check(vehicle.autopilot) if "Drone" in text]


@pytest.mark.parametrize("firmware", CHECKS)
def test_arming_needs_the_operator(firmware):
    simulation = Simulation(seed=1)
    vehicle = simulation.add("copter", firmware, remote_id=True)
    parameters, start = CHECKS[firmware]
    simulation.advance(simulation.now + 30)
    assert problems(vehicle) == []
    for name, value in parameters.items():
        vehicle.parameters.set(name, value)
    assert [text.startswith(start) for text in problems(vehicle)] == [True]
    operator = Operator(47.0, 8.0, uas_id="1596F3")
    sender = RemoteIdSender(GROUND, 1, operator, vehicle.now)
    sender.handle_timeout(vehicle.now)
    harness = VehicleHarness(SimulationHarness.__new__(SimulationHarness), vehicle)
    harness.simulation_harness.collect = lambda: None
    for message in sent_by(sender):
        harness.send(message)
    assert problems(vehicle) == []
    simulation.advance(simulation.now + 7)
    assert [text.startswith(start) for text in problems(vehicle)] == [True]  # the operator is too old
    vehicle.has_remote_id = False
    vehicle.reboot()
    simulation.advance(simulation.now + 30)
    assert [text.startswith(start) for text in problems(vehicle)] == [True]
    assert vehicle.remote_id is None


def test_the_module_reports():
    simulation = Simulation(seed=1)
    vehicle = simulation.add("copter", "ardupilot", remote_id=True)
    assert vehicle.remote_id.problem == "missing BasicID"
    assert vehicle.remote_id._location().status == common.MavOdidStatus.GROUND


def test_the_words_of_ardupilot():
    """They are those of AP_OpenDroneID, in its order; without the option nothing is checked."""
    simulation = Simulation(seed=1)
    vehicle = simulation.add("copter", "ardupilot", remote_id=True)
    simulation.advance(simulation.now + 5)
    vehicle.parameters.set("DID_ENABLE", 1)
    assert problems(vehicle) == []
    vehicle.parameters.set("DID_OPTIONS", 1)
    assert problems(vehicle) == ["OpenDroneID: UA_TYPE required in BasicID"]
    harness = VehicleHarness(SimulationHarness.__new__(SimulationHarness), vehicle)
    harness.simulation_harness.collect = lambda: None
    harness.send(common.OpenDroneIdBasicId(id_type=1, ua_type=2, uas_id=b"1596F3".ljust(20, b"\0")))
    assert problems(vehicle) == ["OpenDroneID: operator location must be set"]
    harness.send(common.OpenDroneIdSystem(operator_latitude=470_000_000, operator_longitude=85_000_000))
    assert problems(vehicle) == []
    simulation.advance(simulation.now + 4)
    assert problems(vehicle) == ["OpenDroneID: SYSTEM not available"]
    vehicle.remote_id = None
    assert problems(vehicle) == ["OpenDroneID: ARM_STATUS not available"]


@pytest.mark.parametrize(("firmware", "passed_on"), [("ardupilot", True), ("px4", False)])
def test_the_autopilot_passes_messages_to_the_module(firmware, passed_on):
    """MAVProxy's module sends to the autopilot, and PX4 takes OPEN_DRONE_ID_SYSTEM alone."""
    simulation = Simulation(seed=1)
    vehicle = simulation.add("copter", firmware, remote_id=True)
    harness = VehicleHarness(SimulationHarness.__new__(SimulationHarness), vehicle)
    harness.simulation_harness.collect = lambda: None
    to_autopilot = {"target_system": 1, "target_component": 1}
    harness.send(common.OpenDroneIdSystem(operator_latitude=1, operator_longitude=1, **to_autopilot))
    harness.send(common.OpenDroneIdBasicId(id_type=1, uas_id=b"1596F3".ljust(20, b"\0"), **to_autopilot))
    assert vehicle.remote_id.problem == ("" if passed_on else "missing BasicID")
    module = {"target_system": 1, "target_component": common.MavComponent.ODID_TXRX_1}
    harness.send(common.OpenDroneIdBasicId(id_type=1, uas_id=b"1596F3".ljust(20, b"\0"), **module))
    assert vehicle.remote_id.problem == ""
