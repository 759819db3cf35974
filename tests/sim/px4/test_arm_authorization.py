"""A simulated PX4 that needs an authoriser to arm: both methods, every answer, and a node as authoriser."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.services.arm_authorization import ArmApproval, ArmRefusal
from mavstack.sim import Simulation
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.sim.harness import CMD, RESULT
from tests.sim.px4.harness import Px4Harness
from tests.sim.running import make_ready, running

AUTHORIZER = 10
ONE_COMMAND, TWO_COMMANDS = 0, 1
REASON = common.MavArmAuthDeniedReason


def strict(method: int) -> Px4Harness:
    harness = Px4Harness()
    for name, value in (("REQ", 1), ("MET", method), ("ID", AUTHORIZER)):
        harness.vehicle.parameters.set(f"COM_ARM_AUTH_{name}", value)
    return harness


def test_without_an_authoriser_nothing_arms():
    harness = strict(ONE_COMMAND)
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.IN_PROGRESS
    harness.run(2)
    assert not harness.autopilot.armed
    assert "Arm auth: No response" in harness.texts


def test_two_commands():
    harness = strict(TWO_COMMANDS)
    for _ in range(2):
        assert harness.command(CMD.COMPONENT_ARM_DISARM, 1, 0) == RESULT.TEMPORARILY_REJECTED
    harness.run(0.1)
    answer = common.CommandAck(command=CMD.ARM_AUTHORIZATION_REQUEST, result=0, result_param2=5)
    harness.send(answer, harness.source._replace(system=AUTHORIZER))
    harness.run(0.2)
    assert "Arm auth: Authorized for the next 5 seconds" in harness.texts
    harness.run(6)  # the approval is valid no more
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1, 0.5) == RESULT.TEMPORARILY_REJECTED


@pytest.mark.parametrize(
    ("answer", "text"),
    [
        (ArmApproval(30), "Arm auth: Authorized for the next 30 seconds"),
        (ArmRefusal(REASON.BAD_WEATHER), "Arm auth: Denied because of bad weather"),
        (ArmRefusal(REASON.INVALID_WAYPOINT, 4), "Arm auth: Denied, waypoint 4 have a invalid value"),
        (ArmRefusal(temporarily=True), "Arm auth: Temporarily rejected"),
        (ArmRefusal(), "Arm auth: Denied"),
    ],
)
def test_a_node_decides(answer, text):
    async def work() -> None:
        simulation = Simulation(seed=1)
        vehicle = simulation.add("copter", "px4")
        make_ready(simulation)
        vehicle.parameters.set("COM_ARM_AUTH_REQ", 1)
        asked, texts = [], []
        vehicle.add_listener(lambda vehicle, kind, text: texts.append(text))
        network = MemoryNetwork()

        async def decide(system: int) -> ArmApproval | ArmRefusal:
            asked.append(system)
            return answer

        async with (
            running(simulation, network.link()),
            connect(network.link()) as connection,
            Node(network.link(), system=AUTHORIZER, component=1) as authorizer,
        ):
            authorizer.serve_arm_authorization(decide)
            remote = await connection.wait_for_vehicle()
            if isinstance(answer, ArmApproval):
                await remote.arm()
            else:
                with pytest.raises(CommandDenied, match="DENIED"):
                    await remote.arm()
            assert vehicle.autopilot.armed == isinstance(answer, ArmApproval)
        assert set(asked) == {1}
        assert text in texts

    run_virtually(work())
