from __future__ import annotations

import asyncio

import pytest

from mavstack import encode
from mavstack.dialects import common
from mavstack.pytest_plugin import flight_controller  # noqa: F401 (the fixture)
from mavstack.router.config import EndpointConfig
from mavstack.router.endpoints.carried import CarriedEndpoint
from mavstack.router.endpoints.native import UdpEndpoint
from mavstack.router.endpoints.server import ServerEndpoint
from tests.router.peers import UdpPeer, arm, heartbeat, port, routing, until


@pytest.mark.parametrize(
    ("url", "kind"),
    [
        ("udpin://127.0.0.1:0", UdpEndpoint),
        ("udpin://127.0.0.1:0?loss=0.1", CarriedEndpoint),
        ("tcpin://127.0.0.1:0", ServerEndpoint),
        ("tcpin://127.0.0.1:0?role=observe", CarriedEndpoint),
        ("wsin://127.0.0.1:0", CarriedEndpoint),
    ],
)
async def test_kinds(url, kind):
    async with routing(EndpointConfig("a", url)) as router:
        assert type(router.endpoints["a"]) is kind


async def test_a_flight_controller_that_speaks_msp(flight_controller):  # noqa: F811
    """Its bridge is within the process of the router."""
    controller = EndpointConfig("controller", f"{flight_controller.url}?system=7")
    async with routing(controller, EndpointConfig("ground", "udpin://127.0.0.1:0")) as router:
        with UdpPeer(port(router, "ground")) as ground:
            ground.send(heartbeat(255, 190))
            await until(lambda: any(each.system == 7 for each in router.statistics().routes))
            assert (await ground.receive())[5] == 7


async def test_roles_hold_in_a_router():
    """A client that may only observe commands no vehicle."""
    observers = EndpointConfig("observers", "tcpin://127.0.0.1:0?role=observe")
    async with routing(EndpointConfig("vehicle", "udpin://127.0.0.1:0"), observers) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle:
            vehicle.send(heartbeat())
            await until(lambda: router.statistics().routes)
            _, writer = await asyncio.open_connection("127.0.0.1", port(router, "observers"))
            station = common.Heartbeat(type=common.MavType.GCS, autopilot=common.MavAutopilot.INVALID)
            beat = encode(station, system=255, component=190)
            writer.write(arm() + beat)
            assert await vehicle.receive() == beat
            assert vehicle.waiting() == 0
            writer.close()
