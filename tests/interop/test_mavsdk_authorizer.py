"""MAVSDK's ArmAuthorizerServer decides whether a simulated PX4 arms."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.node import Node
from mavstack.sim import Simulation
from tests.interop.mavsdk_peer import mavsdk_peer, needs_mavsdk
from tests.sim.running import make_ready, running
from tests.waiting import wait_until

pytestmark = [pytest.mark.interop, needs_mavsdk]

AUTHORIZER = 10
REASON_NUMBER = 5


async def test_mavsdk_decides_whether_a_vehicle_arms() -> None:
    simulation = Simulation(seed=1)
    vehicle = simulation.add("copter", "px4")
    make_ready(simulation)
    texts: list[str] = []
    vehicle.add_listener(lambda _, kind, text: texts.append(text) if kind == "text" else None)
    for name, value in (("REQ", 1), ("ID", AUTHORIZER), ("MET", 1), ("TO", 10.0)):
        vehicle.parameters.set(f"COM_ARM_AUTH_{name}", value)
    async with (
        running(simulation, "udpin://127.0.0.1:0") as simulated,
        mavsdk_peer(f"udpout://127.0.0.1:{simulated.link.address[1]}", "server", AUTHORIZER, 1) as server,
        Node(f"udpout://127.0.0.1:{simulated.link.address[1]}", system=255, component=190) as ground,
    ):
        requests = await server.stream("arm_authorizer_server", "subscribe_arm_authorization")
        await wait_until(
            lambda: any(s.system == AUTHORIZER for s in vehicle.services.discovery.components), timeout=20
        )
        remote = await ground.wait_for_autopilot()
        for answer, text in (
            (("reject_arm_authorization", False, REASON_NUMBER, 0), "Denied because of bad weather"),
            (("accept_arm_authorization", 60), "Authorized for the next 60 seconds"),
        ):
            with pytest.raises(Exception, match="TEMPORARILY_REJECTED"):
                await remote.command(common.MavCmd.COMPONENT_ARM_DISARM, 1)
            assert await requests.get() == 1
            assert await server.call("arm_authorizer_server", *answer) == "SUCCESS"
            await wait_until(lambda text=text: any(text in each for each in texts), timeout=10)
            await asyncio.sleep(0.3)
        await remote.command(common.MavCmd.COMPONENT_ARM_DISARM, 1)
        assert vehicle.autopilot.armed
