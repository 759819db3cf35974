from __future__ import annotations

from math import hypot

import pytest

from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.server.stations import COPTER, Ground, serve

PASSWORDS = {Role.OBSERVE: "watching only", Role.OPERATE: "may fly it", Role.ADMINISTER: "may do it all"}


def test_a_flight() -> None:
    async def scenario(ground: Ground) -> None:
        api, vehicle = ground.api, ground.station.vehicle(1)
        assert (await api.post("/api/vehicles/1/mode", {"mode": "GUIDED"})).json == {
            "system": 1,
            "action": "mode",
            "state": "done",
        }
        assert (await api.post("/api/vehicles/1/arm")).status == 200
        assert (await api.post("/api/vehicles/1/takeoff", {"altitude": 8})).status == 200
        assert vehicle.position.relative_altitude == pytest.approx(8, abs=1)
        place = vehicle.position
        body = {"latitude": place.latitude + 2e-4, "longitude": place.longitude}
        accepted = await api.post("/api/vehicles/1/goto?accepted=true", body)
        assert accepted.json["state"] == "accepted"
        assert vehicle.position.latitude < place.latitude + 1e-4
        assert (await api.post("/api/vehicles/1/altitude", {"altitude": 12})).status == 200
        assert vehicle.position.relative_altitude == pytest.approx(12, abs=1)
        assert (await api.post("/api/vehicles/1/speed", {"speed": 5})).status == 200
        started = await api.post("/api/vehicles/1/land?wait=false", {})
        assert (started.status, started.headers["location"]) == (202, "/api/tasks/1")
        await ground.wait_until(lambda: not vehicle.armed, timeout=120)

    serve(COPTER, scenario)


@pytest.mark.flight
def test_a_plane_has_returned_when_it_circles_home() -> None:
    async def scenario(ground: Ground) -> None:
        api, simulated = ground.api, ground.simulation.vehicles[0]
        assert (await api.post("/api/vehicles/1/arm")).status == 200
        assert (await api.post("/api/vehicles/1/takeoff", {"altitude": 60})).status == 200
        truth = simulated.body.truth
        assert (await api.post("/api/vehicles/1/move", {"north": 200, "up": 30})).status == 200
        assert -simulated.body.truth.down == pytest.approx(truth.down * -1 + 30, abs=8)
        assert (await api.post("/api/vehicles/1/rtl")).status == 200
        truth = simulated.body.truth
        away = hypot(truth.north, truth.east)
        assert away == pytest.approx(60, abs=12)
        closing = abs(truth.north * truth.velocity_north + truth.east * truth.velocity_east) / away
        assert closing < 4.0
        assert abs(truth.velocity_down) < 1.0
        refused = await api.post("/api/vehicles/1/goto", {"latitude": 47, "longitude": 8, "tolerance": -1})
        assert (refused.status, refused.json["error"]["kind"]) == (400, "InvalidArgumentError")

    serve((VehicleType.PLANE, Firmware.ARDUPILOT), scenario)


def test_a_rover_has_no_altitude_to_change() -> None:
    async def scenario(ground: Ground) -> None:
        for path, body in (("altitude", {"altitude": 5}), ("move", {"up": 5})):
            answer = await ground.api.post(f"/api/vehicles/1/{path}", body)
            assert answer.json["error"]["kind"] == "ActionUnsupported"
            assert "it is a rover" in answer.json["error"]["text"]

    serve((VehicleType.ROVER, Firmware.ARDUPILOT), scenario)


def test_a_task_for_an_unknown_vehicle_is_not_begun() -> None:
    async def scenario(ground: Ground) -> None:
        for system, status in (("7", 404), ("none", 404), ("1", 202)):
            answer = await ground.api.post(f"/api/vehicles/{system}/mission/pause?wait=false", {})
            assert answer.status == status
        assert len(ground.station.tasks.list()) == 1

    serve(COPTER, scenario)


def test_a_refusal_has_the_vehicles_reasons() -> None:
    async def scenario(ground: Ground) -> None:
        answer = await ground.api.post("/api/vehicles/1/arm", {})
        error = answer.json["error"]
        assert (answer.status, error["kind"], error["code"]) == (409, "CommandDenied", 4)
        assert any("Arm" in text for text in error["status_texts"])
        unknown = await ground.api.post("/api/vehicles/1/mode", {"mode": "FLY"})
        assert unknown.status == 409

    serve(COPTER, scenario, ready=False)


def test_a_refused_call_changes_nothing_and_arming_leaves_rtl() -> None:
    async def scenario(ground: Ground) -> None:
        api, vehicle = ground.api, ground.station.vehicle(1)
        mode = vehicle.mode
        place = {"latitude": 47.398, "longitude": 8.546}
        for action, body in (("takeoff", {}), ("goto", place), ("rtl", {}), ("mission/start", {})):
            answer = await api.post(f"/api/vehicles/1/{action}", body)
            error = answer.json["error"]
            assert (answer.status, error["kind"]) == (409, "ActionRefused")
            assert error["text"].endswith("failed: it is not armed; arm it first")
            assert vehicle.mode == mode
        await api.post("/api/vehicles/1/mode", {"mode": "RTL"})
        shown = (await api.get("/api/vehicles/1")).json
        assert (shown["ready"], shown["warnings"]) == (False, [])
        assert shown["problems"][0]["text"] == "its firmware does not arm in mode RTL"
        kept = await api.post("/api/vehicles/1/arm", {"keep_mode": True})
        assert kept.json["error"]["kind"] == "ActionRefused"
        assert (await api.post("/api/vehicles/1/arm", {})).status == 200
        assert vehicle.mode == "GUIDED"

    serve(COPTER, scenario)


def test_any_command_by_name_and_number() -> None:
    async def scenario(ground: Ground) -> None:
        for command in ("MAV_CMD_REQUEST_MESSAGE", "request_message", 512):
            answer = await ground.api.post("/api/vehicles/1/command", {"command": command, "params": [148]})
            assert answer.json == {
                "system": 1,
                "command": 512,
                "result": {"result": "ACCEPTED", "detail": 0, "attempts": 1},
            }

    serve(COPTER, scenario)


def test_commands_of_ardupilot_have_names() -> None:
    async def scenario(ground: Ground) -> None:
        body = {"command": "SET_EKF_SOURCE_SET", "params": [2]}
        answer = (await ground.api.post("/api/vehicles/1/command", body)).json
        assert (answer["command"], answer["result"]["result"]) == (42007, "ACCEPTED")

    serve(COPTER, scenario)


@pytest.mark.parametrize(
    ("path", "body", "problem"),
    [
        ("takeoff", {"altitude": -5}, "altitude must be positive"),
        ("takeoff", {"altitude": "high"}, "altitude must be a number, got 'high'"),
        ("takeoff", {"altitud": 5}, "there is no field 'altitud': did you mean altitude?"),
        ("goto", {"latitude": 47}, "longitude is missing: Degrees."),
        ("goto", {"latitude": 91, "longitude": 8}, "latitude must be a number from -90 to 90, got 91"),
        ("arm", {"force": 1}, "force must be true or false, got 1"),
        ("command", {"command": "NAV_TAKEOF"}, "there is no command 'NAV_TAKEOF'"),
        ("command", {"command": 16.5}, "command must be a name or a number from 0 to 65535"),
        (
            "command",
            {"command": 16, "params": [0] * 8},
            "params must be an array of at most 7 values, each a number, got",
        ),
        (
            "command",
            {"command": 16, "params": ["x"]},
            "params must be an array of at most 7 values, each a number",
        ),
        ("mission/current", {"seq": -1}, "seq must be an integer of at least 0, got -1"),
        ("arm?wait=perhaps", {}, "wait must be true or false, got 'perhaps'"),
        ("arm?await=1", {}, "there is no field 'await'"),
    ],
)
def test_wrong_requests(path: str, body: object, problem: str) -> None:
    async def scenario(ground: Ground) -> None:
        answer = await ground.api.post(f"/api/vehicles/1/{path}", body)
        assert (answer.status, problem in answer.problem) == (400, True), answer.problem

    serve(COPTER, scenario, ready=False)


def test_roles_limit_actions_and_commands() -> None:
    async def scenario(ground: Ground) -> None:
        async def status(role: Role, path: str, body: object) -> int:
            began = await ground.api.post("/api/session", {"password": PASSWORDS[role]})
            headers = {"authorization": f"Bearer {began.json['token']}"}
            return (await ground.api.post(f"/api/vehicles/1/{path}", body, headers=headers)).status

        assert (await ground.api.post("/api/vehicles/1/hold")).status == 401
        assert await status(Role.OBSERVE, "hold", {}) == 403
        assert await status(Role.OPERATE, "mode", {"mode": "GUIDED"}) == 200
        assert await status(Role.OPERATE, "reboot", {}) == 403
        assert await status(Role.OPERATE, "command", {"command": "PREFLIGHT_REBOOT_SHUTDOWN"}) == 403
        assert await status(Role.OPERATE, "command", {"command": "NAV_RETURN_TO_LAUNCH"}) in (200, 409)
        assert await status(Role.ADMINISTER, "command", {"command": "DO_SET_HOME", "params": [1]}) == 200

    serve(COPTER, scenario, access=Access(passwords=PASSWORDS, local=False))
