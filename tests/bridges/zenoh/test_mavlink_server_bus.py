"""Programs that were written for mavlink-server, on a real Zenoh router beside the gateway."""

from __future__ import annotations

import asyncio
import json
from typing import TYPE_CHECKING, Any

import pytest

from mavstack import Parser, encode
from mavstack.bridges.zenoh.mavlink_server import MavlinkServerKeys
from mavstack.dialects import Dialect, common
from mavstack.security.roles import Role
from mavstack.sim.background import BackgroundSimulator
from tests.bridges.zenoh.running import fleet, until, zenoh_client, zenoh_router

if TYPE_CHECKING:
    from collections.abc import Callable

pytestmark = pytest.mark.interop
REQUEST = common.ParamRequestRead(target_system=1, target_component=1, param_id="RTL_ALT", param_index=-1)


def run(scenario: Any, role: Role = Role.ADMINISTER) -> None:
    """Run a scenario with the keys of one simulated copter, and a session of another program."""

    async def gateway(port: int, url: str) -> None:
        async with fleet(url, port, role=role) as (connection, opened):
            with MavlinkServerKeys(connection, opened._bus, role) as keys:
                session = zenoh_client(port)
                try:
                    await scenario(keys, session)
                finally:
                    session.close()

    with BackgroundSimulator("copter") as simulator, zenoh_router() as port:
        asyncio.run(gateway(port, simulator.url))


def subscribed(session: Any, key: str) -> dict[str, Any]:
    """Return the last value of each key that arrives, and its encoding."""
    found: dict[str, Any] = {}

    def receive(sample: Any) -> None:
        found[str(sample.key_expr)] = json.loads(bytes(sample.payload))
        assert str(sample.encoding) == "application/json"

    session.declare_subscriber(key, receive)
    return found


def answers(session: Any) -> list[Any]:
    """Return the values of RTL_ALT that the vehicle sends from now on."""
    parser, found = Parser(Dialect.load("all")), []

    def receive(sample: Any) -> None:
        messages = (packet.message for packet in parser.feed(bytes(sample.payload)))
        found.extend(
            each.param_value
            for each in messages
            if isinstance(each, common.ParamValue) and each.param_id == "RTL_ALT"
        )

    session.declare_subscriber("mavlink_raw/out", receive)
    return found


async def repeat(send: Callable[[], None], arrived: Callable[[], object]) -> None:
    """Send until something arrived: subscriptions take time on their way through the router."""
    for _ in range(100):
        send()
        await asyncio.sleep(0.1)
        if arrived():
            return
    pytest.fail("nothing arrived in 10 seconds")


def test_messages_arrive_by_all_keys() -> None:
    async def scenario(keys: Any, session: Any) -> None:
        everything = subscribed(session, "mavlink/out")
        attitudes = subscribed(session, "mavlink/1/1/ATTITUDE")
        fields = subscribed(session, "mavlink/1/*/HEARTBEAT/*")
        await until(lambda: everything and attitudes and len(fields) == 7)
        assert everything["mavlink/out"]["header"]["system_id"] == 1
        found = attitudes["mavlink/1/1/ATTITUDE"]
        assert (found["header"]["message_id"], found["message"]["type"]) == (30, "ATTITUDE")
        assert abs(found["message"]["roll"]) < 1
        assert fields["mavlink/1/1/HEARTBEAT/mavtype"] == {"type": "MAV_TYPE_QUADROTOR"}
        assert fields["mavlink/1/1/HEARTBEAT/type"] == "HEARTBEAT"

    run(scenario)


def test_packets_and_messages_reach_the_vehicle() -> None:
    async def scenario(keys: Any, session: Any) -> None:
        found = answers(session)
        raw = encode(REQUEST, system=250, component=190, sequence=0)
        await repeat(lambda: session.put("mavlink_raw/in", raw), lambda: found)
        assert found[0] == 1500
        message = {
            "type": "PARAM_SET",
            "target_system": 1,
            "target_component": 1,
            "param_id": "RTL_ALT",
            "param_value": 2000,
            "param_type": {"type": "MAV_PARAM_TYPE_INT32"},
        }
        text = json.dumps({"header": {"system_id": 250, "component_id": 190}, "message": message})
        await repeat(lambda: session.put("mavlink/in", text), lambda: 2000 in found)
        session.put("mavlink/in", "{")
        await until(lambda: keys.guard.refused["is not a message"])

    run(scenario)


def test_nothing_reaches_the_vehicle_of_an_observer() -> None:
    async def scenario(keys: Any, session: Any) -> None:
        found, heartbeats = answers(session), subscribed(session, "mavlink/1/1/HEARTBEAT")
        raw = encode(REQUEST, system=250, component=190, sequence=0)
        await repeat(lambda: session.put("mavlink_raw/in", raw), lambda: heartbeats)
        heartbeats.clear()  # whatever the requests bring would arrive before the next heartbeat
        await until(lambda: heartbeats)
        assert not found
        assert keys.guard.accepted == 0

    run(scenario, Role.OBSERVE)
