from __future__ import annotations

import asyncio
import json

from mavstack.dialects import common
from mavstack.security.roles import Role
from mavstack.server.access import Access
from tests.server.stations import COPTER, Ground, serve

PASSWORDS = {Role.OBSERVE: "watching only"}


def test_messages_are_listed_and_shown() -> None:
    async def scenario(ground: Ground) -> None:
        latest = ground.station.packets.latest
        await ground.wait_until(lambda: (found := latest.find(1, 0)) and found.count > 5)
        listed = (await ground.api.get("/api/vehicles/1/messages")).json
        heartbeat = next(each for each in listed if each["message"] == "HEARTBEAT")
        assert (heartbeat["id"], heartbeat["component"], 0.9 < heartbeat["rate"] < 1.1) == (0, 1, True)
        shown = (await ground.api.get("/api/vehicles/1/messages/heartbeat")).json
        assert (shown["message"], shown["system"], shown["component"]) == ("HEARTBEAT", 1, 1)
        assert shown["fields"]["autopilot"] == common.MavAutopilot.ARDUPILOTMEGA
        for name in ("CAMERA_SETTINGS", "NO_SUCH"):
            assert (await ground.api.get(f"/api/vehicles/1/messages/{name}")).status == 404
        assert (await ground.api.get("/api/vehicles/1/messages/HEARTBEAT?component=7")).status == 404

    serve(COPTER, scenario)


def test_a_message_is_sent_by_name() -> None:
    async def scenario(ground: Ground) -> None:
        fields = {"target_system": 1, "target_component": 1, "command": 512, "param1": 148, "param7": None}
        sent = await ground.api.post("/api/messages", {"message": "COMMAND_LONG", "fields": fields})
        assert sent.json == {"message": "COMMAND_LONG", "system": 255, "component": 190}
        vehicle = ground.station.vehicle(1)
        await ground.wait_until(lambda: vehicle.version is not None)
        for body, kind in [
            ({"message": "COMMAND_LONG", "fields": {"nothing": 1}}, "FieldNameError"),
            ({"message": "COMMAND_LONG", "fields": {"command": 1 << 40}}, "FieldRangeError"),
            ({"message": "COMMAND_LONG", "fields": {"command": [1]}}, "FieldTypeError"),
            ({"message": "COMMAND_LONG", "fields": []}, "BadRequest"),
            ({"message": "DEBUG_FLOAT_ARRAY", "fields": {"data": [[[1]]]}}, "BadRequest"),
        ]:
            answer = await ground.api.post("/api/messages", body)
            assert (answer.status, answer.kind) == (400, kind)

    serve(COPTER, scenario)


def test_messages_are_streamed_by_name() -> None:
    async def scenario(ground: Ground) -> None:
        clients = ground.station.packets.clients
        path = "/api/vehicles/1/messages/heartbeat/stream"
        answer = await ground.api.get(f"{path}?count=3&component=1")
        assert answer.headers["content-type"].startswith("text/event-stream")
        *events, rest = answer.data.decode().split("\n\n")
        messages = [json.loads(each.removeprefix("data: ")) for each in events]
        assert [(each["message"], each["system"]) for each in messages] == [("HEARTBEAT", 1)] * 3
        assert (rest, clients) == ("", set())
        slow = await ground.api.get(f"{path}?count=2&rate=0.2")
        first, second, _ = slow.data.decode().split("\n\n")
        times = [json.loads(each.removeprefix("data: "))["time"] for each in (first, second)]
        assert 4.5 < times[1] - times[0] < 6.0
        for wrong in (f"{path}?rate=0", path.replace("heartbeat", "NO_SUCH"), path.replace("/1/", "/9/")):
            assert (await ground.api.get(wrong)).status in (400, 404)

    serve(COPTER, scenario)


def test_a_stream_is_of_one_vehicle() -> None:
    async def scenario(ground: Ground) -> None:
        for system in (1, 2):
            answer = await ground.api.get(f"/api/vehicles/{system}/messages/HEARTBEAT/stream?count=3")
            events = answer.data.decode().split("\n\n")[:-1]
            assert [json.loads(each.removeprefix("data: "))["system"] for each in events] == [system] * 3

    serve((COPTER, COPTER), scenario)


def test_a_client_that_leaves_ends_its_stream() -> None:
    async def scenario(ground: Ground) -> None:
        clients = ground.station.packets.clients
        path = "/api/vehicles/1/messages/HEARTBEAT/stream"
        reading = asyncio.create_task(ground.api.get(path))
        await ground.wait_until(lambda: clients)
        reading.cancel()
        await asyncio.wait([reading])
        assert not clients

    serve(COPTER, scenario)


def test_streams_count_as_clients(monkeypatch) -> None:
    monkeypatch.setattr("mavstack.server.client_shares.MAX_STREAMS", 0)

    async def scenario(ground: Ground) -> None:
        assert (await ground.api.get("/api/vehicles/1/messages/HEARTBEAT/stream")).status == 429

    serve(COPTER, scenario)


def test_roles_limit_messages() -> None:
    async def scenario(ground: Ground) -> None:
        begun = await ground.api.post("/api/session", {"password": PASSWORDS[Role.OBSERVE]})
        ground.api.headers = {"authorization": f"Bearer {begun.json['token']}"}
        statuses = [
            (await ground.api.post("/api/messages", {"message": name})).status
            for name in ("PING", "PARAM_SET", "COMMAND_LONG", "SETUP_SIGNING")
        ]
        assert statuses == [200, 403, 403, 403]

    serve((), scenario, access=Access(passwords=PASSWORDS, local=False))
