"""A gateway of simulated vehicles, and stations over a real Zenoh router."""

from __future__ import annotations

import asyncio
import json
from typing import TYPE_CHECKING, Any

import pytest

from mavstack import encode
from mavstack.bridges.core.calls import CALLS
from mavstack.bridges.core.zenoh_session import SessionOptions
from mavstack.bridges.zenoh.bus import Bus
from mavstack.bridges.zenoh.gateway import Gateway, GatewayOptions
from mavstack.dialects import common
from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.sim.background import BackgroundSimulator
from mavstack.vehicle import Connection
from tests.bridges.zenoh.running import fleet, get, until, zenoh_client, zenoh_router
from tests.bridges.zenoh.test_link import zenoh_link
from tests.server.asgi import ApiClient

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.interop
ARM = "mavstack/alpha/command/arm"


@pytest.fixture(name="router")
def _router() -> Iterator[int]:
    with zenoh_router() as port:
        yield port


def run(router: int, scenario: Any, *, count: int = 1, **options: Any) -> None:
    """Run a scenario with a gateway of simulated copters, the first one of which is alpha."""

    async def gateway() -> None:
        options.setdefault("names", {1: "alpha"})
        async with fleet(simulator.url, router, count=count, **options) as (connection, opened):
            session = zenoh_client(router)
            try:
                await scenario(connection, opened, session)
            finally:
                session.close()

    with BackgroundSimulator("copter", count=count, speed=3) as simulator:
        asyncio.run(gateway())


@pytest.mark.smoke
def test_a_station_far_away_flies_the_fleet(router: int) -> None:
    async def scenario(connection: Any, gateway: Any, session: Any) -> None:
        async with Connection(zenoh_link(f"zenoh://127.0.0.1:{router}")) as far:
            await far.wait_for_vehicles(2)
            assert {channel.peer for channel in far.links[0].channels} == {"alpha", "sys2"}
            vehicle = far.vehicles[2]
            assert (await vehicle.params.get("RTL_ALT")).value == 1500
            await vehicle.wait_until_ready()
            await vehicle.set_mode("GUIDED")
            await vehicle.arm()
            assert vehicle.armed
            assert not far.vehicles[1].armed
        guards = [gateway.vehicles[system].guard for system in (1, 2)]
        assert not any(guard.refused for guard in guards)
        assert guards[1].accepted > 3

    run(router, scenario, count=2)


def test_the_station_shows_each_vehicle_once(router: int) -> None:
    """Two gateways, and one of the vehicles is behind both."""

    async def scenario(connection: Any, gateway: Any, session: Any) -> None:
        bus = Bus(SessionOptions((f"tcp/127.0.0.1:{router}",)), "second")
        async with (
            Gateway(connection, bus, GatewayOptions(names={1: "gamma"})) as second,
            Station(network_only=True) as station,
        ):
            await until(lambda: len(second.vehicles) == 3)
            api = ApiClient(make_app(station, Access(), static=None))
            source = {"url": f"zenoh://127.0.0.1:{router}"}
            assert (await api.post("/api/sources", source)).status == 201
            await until(lambda: len(station.connection.vehicles) == 3)
            (found,) = (await api.get("/api/sources")).json
            assert sorted(found["channels"]) == ["zenoh alpha", "zenoh gamma", "zenoh sys2", "zenoh sys3"]
            vehicles = (await api.get("/api/vehicles")).json
            assert [(each["system"], each["has_id_conflict"]) for each in vehicles] == [
                (1, False),
                (2, False),
                (3, False),
            ]

    run(router, scenario, count=3)


def test_messages_states_and_tokens(router: int) -> None:
    zenoh = pytest.importorskip("zenoh")

    async def scenario(connection: Any, gateway: Any, session: Any) -> None:
        messages: dict[str, Any] = {}

        def receive(sample: Any) -> None:
            messages[str(sample.key_expr)] = json.loads(bytes(sample.payload))

        session.declare_subscriber("mavstack/*/message/1/ATTITUDE", receive)
        await until(lambda: messages)
        (key,) = messages
        assert key == "mavstack/alpha/message/1/ATTITUDE"
        assert abs(messages[key]["fields"]["roll"]) < 1
        await until(lambda: gateway.vehicles[1]._states.keys() >= {"status", "position"})
        late: dict[str, Any] = {}
        history = zenoh.ext.HistoryConfig(detect_late_publishers=True)
        subscriber = zenoh.ext.declare_advanced_subscriber(
            session,
            "mavstack/*/state/*",
            lambda sample: late.setdefault(str(sample.key_expr), json.loads(bytes(sample.payload))),
            history=history,
        )
        await until(lambda: "mavstack/alpha/state/status" in late)
        assert late["mavstack/alpha/state/status"]["armed"] is False
        subscriber.undeclare()
        states = await get(session, "mavstack/*/state/*")
        assert states["mavstack/alpha/state/status"]["system"] == 1
        tokens = [str(reply.ok.key_expr) for reply in session.liveliness().get("mavstack/**", timeout=5)]
        assert tokens == ["mavstack/alpha/alive/g1"]
        gateways = session.liveliness().get("mavstack/@gateway/*", timeout=5)
        assert [str(reply.ok.key_expr) for reply in gateways] == ["mavstack/@gateway/g1"]

    run(router, scenario)


def test_commands_have_the_reason_and_are_carried_out_once(router: int) -> None:
    async def scenario(connection: Any, gateway: Any, session: Any) -> None:
        vehicle = connection.vehicles[1]
        await vehicle.wait_until_ready()
        takeoff = "mavstack/alpha/command/action/takeoff"
        refused = (await get(session, takeoff, b'{"altitude": 5}'))[takeoff]
        assert refused["ok"] is False
        assert "it is not armed" in refused["reason"]
        mode = "mavstack/*/command/set_mode"
        assert (await get(session, mode, b'{"custom_mode": "GUIDED"}'))[mode.replace("*", "alpha")]["ok"]
        sent: list[bytes] = []
        listener = connection._host.sent_listeners
        listener.append(sent.append)
        replies = [(await get(session, f"{ARM}?id=7"))[ARM] for _ in range(3)]
        arms = [data for data in sent if data[7:10] == bytes((76, 0, 0)) and data[38:40] == bytes((144, 1))]
        assert replies == [{"ok": True, "result": {"success": True}}] * 3
        assert len(arms) == 1
        assert vehicle.armed
        late = (await get(session, f"{ARM}?expires=5"))[ARM]
        assert late["ok"] is False
        assert "after it expired" in late["reason"]
        unknown = await get(session, "mavstack/alpha/command/fly")
        assert "there is no command 'fly'" in unknown["error"]
        everything = await get(session, "mavstack/**")
        assert not any("/command/" in key for key in everything)

    run(router, scenario)


def test_an_observing_gateway_passes_nothing_on(router: int) -> None:
    async def scenario(connection: Any, gateway: Any, session: Any) -> None:
        sent: list[bytes] = []
        connection._host.sent_listeners.append(sent.append)
        for name, row in CALLS.items():
            if row.role > Role.OBSERVE:
                key = f"mavstack/alpha/command/{name}"
                assert (await get(session, key))[key]["reason"].startswith("control is not allowed")
        arm = common.CommandLong(target_system=1, command=400, param1=1)
        for _ in range(3):
            session.put("mavstack/alpha/frame/in", encode(arm, system=255, component=190, sequence=0))
        await asyncio.sleep(0.5)
        assert not [data for data in sent if data[7] in (76, 75, 23)]

    run(router, scenario, role=Role.OBSERVE)


def test_two_gateways_with_one_name_pass_nothing_on(router: int) -> None:
    async def scenario(connection: Any, gateway: Any, session: Any) -> None:
        rival = session.liveliness().declare_token("mavstack/alpha/alive/other")
        await until(lambda: gateway.vehicles[1].rivals == {"other"})
        refused = (await get(session, ARM))[ARM]
        assert "the gateway other serves a vehicle of this name too" in refused["reason"]
        session.put(
            "mavstack/alpha/frame/in", encode(common.Heartbeat(), system=255, component=190, sequence=0)
        )
        await until(lambda: gateway.vehicles[1].guard.refused["two gateways serve the vehicle"] == 1)
        rival.undeclare()
        await until(lambda: not gateway.vehicles[1].rivals)
        assert (await get(session, "mavstack/alpha/command/disarm"))["mavstack/alpha/command/disarm"]["ok"]

    run(router, scenario)


def test_what_others_send_ends_nothing(router: int) -> None:
    async def scenario(connection: Any, gateway: Any, session: Any) -> None:
        from random import Random

        rng = Random(1)
        for size in (0, 3, 40, 400):
            session.put("mavstack/alpha/frame/in", rng.randbytes(size))
        for name in CALLS:
            key = f"mavstack/alpha/command/{name}"
            for payload in (rng.randbytes(9), b"[]", b'{"altitude": NaN}', b'{"value": 2}'):
                answer = (await get(session, key, payload))[key]
                assert answer["ok"] is False, (name, payload)
                assert answer["reason"]
        states = await get(session, "mavstack/alpha/state/status")
        assert states["mavstack/alpha/state/status"]["connected"] is True

    run(router, scenario)


def test_a_lost_vehicle_loses_its_token(router: int) -> None:
    async def scenario(connection: Any, gateway: Any, session: Any) -> None:
        gone: list[bool] = []
        zenoh = pytest.importorskip("zenoh")
        session.liveliness().declare_subscriber(
            "mavstack/*/alive/*", lambda sample: gone.append(sample.kind == zenoh.SampleKind.DELETE)
        )
        gateway.vehicles[1].set_connected(connected=False)
        await until(lambda: True in gone)
        gateway.vehicles[1].set_connected(connected=True)
        await until(lambda: gone[-1] is False)

    run(router, scenario)
