from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.security.roles import Role
from mavstack.server import raw_client
from mavstack.server.access import Access
from mavstack.server.websockets import choose_subprotocol
from mavstack.wire import Encoder, Parser
from tests.server.asgi import RefusedSocketError
from tests.server.stations import COPTER, Ground, serve

PASSWORDS = {Role.OBSERVE: "watching only", Role.ADMINISTER: "may do it all"}
REBOOT = common.CommandLong(
    target_system=1, target_component=1, command=common.MavCmd.PREFLIGHT_REBOOT_SHUTDOWN, param1=1
)
ASK = common.CommandLong(
    target_system=1, target_component=1, command=common.MavCmd.REQUEST_MESSAGE, param1=148
)


async def messages(socket, ground, *kinds, count=200):
    """Read raw packets until one of these classes comes."""
    parser = Parser(ground.station.connection.dialect)
    for _ in range(count):
        for packet in parser.feed(await socket.receive()):
            if isinstance(packet.message, kinds):
                return packet
    raise AssertionError(f"none of {kinds}")


def encode(message, system=245, component=191):
    return Encoder(system, component).encode(message)


def test_raw_packets_in_both_directions() -> None:
    async def scenario(ground: Ground) -> None:
        async with ground.api.websocket("mavstack.raw.1") as socket:
            assert socket.subprotocol == "mavstack.raw.1"
            await messages(socket, ground, common.Heartbeat)
            await socket.send(encode(ASK))
            answer = await messages(socket, ground, common.CommandAck)
            assert (answer.message.target_system, answer.message.target_component) == (245, 191)
        assert ground.station.packets.clients == set()

    serve(COPTER, scenario)


def test_json_subscriptions_with_a_rate() -> None:
    async def scenario(ground: Ground) -> None:
        now = ground.station.connection.now
        async with ground.api.websocket("mavstack.json.1") as socket:
            await socket.send({"subscribe": ["ATTITUDE"], "rate": 2, "system": 1})
            first = await socket.receive()
            assert (first["message"], first["system"], first["component"]) == ("ATTITUDE", 1, 1)
            assert set(first["fields"]) >= {"time_boot_ms", "roll", "pitch", "yaw"}
            begun = now()
            for _ in range(10):
                assert (await socket.receive())["message"] == "ATTITUDE"
            assert now() - begun == pytest.approx(5, abs=0.6)
            await socket.send({"unsubscribe": ["ATTITUDE"]})
            await socket.send({"subscribe": ["*"], "component": 77})
            await asyncio.sleep(1)
            socket.clear()
            with pytest.raises(TimeoutError):
                await socket.receive(3)

    serve(COPTER, scenario, full_telemetry=True)


def test_json_requests_that_are_not_valid_are_answered() -> None:
    async def scenario(ground: Ground) -> None:
        async with ground.api.websocket("mavstack.json.1") as socket:
            for request, kind in [
                ("{", "BadRequest"),
                (b"\xff", "BadRequest"),
                ({"subscribe": ["NO_SUCH"]}, "UnknownMessageError"),
                ({"subscribe": "ATTITUDE"}, "BadRequest"),
                ({"subscribe": [1]}, "BadRequest"),
                ({"subscribe": [], "rate": 0}, "BadRequest"),
                ({"send": {"message": "PING", "fields": {"nothing": 1}}}, "FieldNameError"),
                ({"send": {"message": "PING", "fields": {"seq": -1}}}, "FieldRangeError"),
                ({"send": {}}, "BadRequest"),
                ({}, "BadRequest"),
            ]:
                await socket.send(request)
                assert (await socket.receive())["error"]["kind"] == kind, request

    serve(COPTER, scenario, ready=False)


def test_a_slow_client_loses_its_own_packets_only(monkeypatch) -> None:
    monkeypatch.setattr(raw_client, "MAX_QUEUE", 2000)

    async def scenario(ground: Ground) -> None:
        async with ground.api.websocket() as slow, ground.api.websocket() as quick:
            slow.pause()
            for _ in range(100):
                await quick.receive()
            clients = ground.station.packets.clients
            drops = sorted(client.queue.dropped for client in clients)
            assert drops[0] == 0
            assert drops[1] > 0
            slow.resume()
            await slow.receive()

    serve(COPTER, scenario, full_telemetry=True)


def test_roles_hold_for_raw_packets() -> None:
    async def scenario(ground: Ground) -> None:
        answer = await ground.api.post("/api/session", {"password": PASSWORDS[Role.OBSERVE]})
        ticket = answer.json["ticket"]
        vehicle = ground.simulation.vehicles[0]
        async with ground.api.websocket("ados-ws-ticket", ticket, "mavstack.raw.1") as socket:
            await socket.send(encode(REBOOT))
            await socket.send(encode(ASK))
            ack = await messages(socket, ground, common.CommandAck)
            assert ack.message.command == common.MavCmd.REQUEST_MESSAGE
            assert vehicle.autopilot.booted

    serve(COPTER, scenario, access=Access(passwords=PASSWORDS, local=False))


def test_clients_without_a_ticket_or_from_other_pages_are_refused() -> None:
    async def scenario(ground: Ground) -> None:
        for headers, status in [({}, 401), ({"origin": "https://evil.example"}, 403)]:
            with pytest.raises(RefusedSocketError, match=str(status)):
                async with ground.api.websocket("mavstack.raw.1", headers=headers):
                    pass
        with pytest.raises(RefusedSocketError, match="400"):
            async with ground.api.websocket("mqtt"):
                pass
        with pytest.raises(RefusedSocketError, match="401"):
            async with ground.api.websocket("ados-ws-ticket", "nonsense", "mavstack.raw.1"):
                pass

    serve((), scenario, access=Access(passwords=PASSWORDS, local=False))


@pytest.mark.parametrize(
    ("offered", "chosen"),
    [
        ([], None),
        (["mavstack.json.1"], "mavstack.json.1"),
        (["ados-ws-ticket", "t", "mavstack.json.1"], "mavstack.json.1"),
        (["ados-ws-ticket", "t"], "ados-ws-ticket"),
    ],
)
def test_the_chosen_subprotocol_is_one_that_the_client_offers(offered, chosen) -> None:
    assert choose_subprotocol(offered) == chosen
