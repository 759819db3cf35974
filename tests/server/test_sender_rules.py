"""Clients below administrators speak in the name of no vehicle, and those that observe in no name at all."""

from __future__ import annotations

from typing import Any

import pytest

from mavstack.dialects import common
from mavstack.node import Node
from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.vehicle import Connection
from mavstack.wire import Encoder
from tests.server.stations import COPTER, Ground, serve

PASSWORDS = {
    Role.OBSERVE: "watching only",
    Role.OPERATE: "may fly it",
    Role.ADMINISTER: "may do it all",
}
OWN, VEHICLE, STATION = (245, 191), (1, 1), (255, 190)
GROUND_STATION = common.Heartbeat(type=common.MavType.GCS, autopilot=common.MavAutopilot.INVALID)
AUTOPILOT = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)
ASK = common.CommandLong(
    target_system=1, target_component=1, command=common.MavCmd.REQUEST_MESSAGE, param1=148
)
ACK = common.MissionAck(target_system=1, target_component=1)
STICKS = common.ManualControl(target=1, z=500)
LAST = common.Ping(seq=4711)


def record_forwarded(monkeypatch: Any) -> list[bytes]:
    """Keep the packets of clients that are sent, instead of sending them."""
    forwarded: list[bytes] = []
    monkeypatch.setattr(Connection, "forward", lambda _, packet: forwarded.append(packet.raw))
    return forwarded


@pytest.mark.parametrize(
    ("role", "message", "sender", "passes"),
    [
        (Role.OBSERVE, GROUND_STATION, OWN, False),
        (Role.OBSERVE, GROUND_STATION, STATION, False),
        (Role.OBSERVE, AUTOPILOT, OWN, False),
        (Role.OBSERVE, ASK, OWN, True),
        (Role.OBSERVE, ASK, STATION, True),  # as the page asks
        (Role.OBSERVE, ASK, VEHICLE, False),
        (Role.OBSERVE, ASK, (1, 191), False),
        (Role.OBSERVE, ACK, OWN, False),
        (Role.OPERATE, GROUND_STATION, OWN, True),
        (Role.OPERATE, AUTOPILOT, OWN, False),
        (Role.OPERATE, GROUND_STATION, VEHICLE, False),
        (Role.OPERATE, STICKS, STATION, True),
        (Role.OPERATE, STICKS, (1, 190), False),
        (Role.OPERATE, ACK, OWN, True),
        (Role.ADMINISTER, AUTOPILOT, OWN, True),
        (Role.ADMINISTER, ASK, VEHICLE, True),
    ],
)
def test_raw_packets(
    monkeypatch: Any, role: Role, message: Any, sender: tuple[int, int], passes: bool
) -> None:
    async def scenario(ground: Ground) -> None:
        forwarded = record_forwarded(monkeypatch)
        answer = await ground.api.post("/api/session", {"password": PASSWORDS[role]})
        async with ground.api.websocket("ados-ws-ticket", answer.json["ticket"], "mavstack.raw.1") as socket:
            sent, last = Encoder(*sender).encode(message), Encoder(*OWN).encode(LAST)
            await socket.send(sent)
            await socket.send(last)
            await ground.wait_until(lambda: last in forwarded)
            assert (sent in forwarded) is passes

    serve(COPTER, scenario, access=Access(passwords=PASSWORDS, local=False))


def test_other_ground_stations_are_not_spoken_for_by_observers(monkeypatch: Any) -> None:
    async def scenario(ground: Ground) -> None:
        forwarded = record_forwarded(monkeypatch)
        connection = ground.station.connection
        async with Node(ground.network.link(), system=250, component=190, type=common.MavType.GCS):
            await ground.wait_until(lambda: (250, 190) in connection.components)
            answer = await ground.api.post("/api/session", {"password": PASSWORDS[Role.OBSERVE]})
            ticket = answer.json["ticket"]
            async with ground.api.websocket("ados-ws-ticket", ticket, "mavstack.raw.1") as socket:
                sent, last = Encoder(250, 190).encode(ASK), Encoder(*OWN).encode(LAST)
                await socket.send(sent + last)
                await ground.wait_until(lambda: last in forwarded)
                assert sent not in forwarded

    serve(COPTER, scenario, access=Access(passwords=PASSWORDS, local=False))


@pytest.mark.parametrize(
    ("role", "name", "status"),
    [
        (Role.OBSERVE, "PING", 200),
        (Role.OBSERVE, "PARAM_REQUEST_LIST", 200),
        (Role.OBSERVE, "HEARTBEAT", 403),
        (Role.OBSERVE, "MISSION_ACK", 403),
        (Role.OPERATE, "MISSION_ACK", 200),
        (Role.OPERATE, "HEARTBEAT", 403),
        (Role.ADMINISTER, "HEARTBEAT", 200),
    ],
)
def test_messages_in_the_name_of_the_station(role: Role, name: str, status: int) -> None:
    async def scenario(ground: Ground) -> None:
        answer = await ground.api.post("/api/session", {"password": PASSWORDS[role]})
        headers = {"authorization": f"Bearer {answer.json['token']}"}
        body = {"message": name, "fields": {}}
        sent = await ground.api.post("/api/messages", body, headers=headers)
        assert sent.status == status
        ticket = answer.json["ticket"]
        async with ground.api.websocket("ados-ws-ticket", ticket, "mavstack.json.1") as socket:
            other = {"target_system": 2} if role is Role.OBSERVE and status == 200 else {}
            await socket.send({"send": body | {"fields": other}})
            await socket.send({})  # its answer comes behind that of the other request
            kinds = [(await socket.receive())["error"]["kind"] for _ in range(1 if status == 200 else 2)]
            assert kinds[0] == ("BadRequest" if status == 200 else "Forbidden")

    serve((), scenario, access=Access(passwords=PASSWORDS, local=False))
