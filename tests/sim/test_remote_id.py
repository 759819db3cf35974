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
    "ardupilot": ("DID_ENABLE", 1, "OpenDroneID: "),
    "px4": ("COM_ARM_ODID", 2, "Preflight Fail: Open Drone ID system "),
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
    name, value, start = CHECKS[firmware]
    simulation.advance(simulation.now + 30)
    assert problems(vehicle) == []
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
