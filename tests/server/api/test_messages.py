from __future__ import annotations

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
