from __future__ import annotations

import json

import pytest

from mavstack.dialects import common
from mavstack.files.plans import FORMATS, PlanFile, format_plan
from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.services.mission import MissionItem
from mavstack.sim.vehicle_types import DEFAULT_HOME as HOME
from mavstack.vehicle.mission import VehiclePlan
from tests.server.stations import COPTER, PX4_COPTER, Ground, serve

PLACES = [(HOME.latitude + number * 1e-4, HOME.longitude) for number in range(3)]
PLAN = PlanFile.of([MissionItem.waypoint(*place, 20.0) for place in PLACES])


@pytest.mark.parametrize("kind", [COPTER, PX4_COPTER], ids=["ardupilot", "px4"])
def test_a_mission_is_uploaded_downloaded_and_removed(kind) -> None:
    async def scenario(ground: Ground) -> None:
        path = "/api/vehicles/1/mission"
        uploaded = await ground.api.put(path, data=format_plan(PLAN, "plan").text.encode())
        assert (uploaded.status, uploaded.json["items"]) == (200, 3 + (kind is COPTER))
        found = (await ground.api.get(path)).json
        assert [each["params"][4:6] for each in found["mission"]] == [pytest.approx(each) for each in PLACES]
        again = await ground.api.put(path, data=json.dumps(found).encode())
        assert (again.status, again.json["items"]) == (200, uploaded.json["items"])
        text = (await ground.api.get(f"{path}?format=waypoints")).data.decode()
        assert text.startswith("QGC WPL 110")
        assert (await ground.api.delete(path)).json == {"system": 1, "items": 0}
        assert (await ground.api.get(path)).json["mission"] == []

    serve(kind, scenario)


#: A command of ArduPilot's dialect, and numbers that no dialect and both dialects define.
ALTITUDE_WAIT, UNKNOWN, DELAY = 83, 31_999, 93


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        (COPTER, ["NAV_ALTITUDE_WAIT", "MAV_CMD 31999", "NAV_DELAY"]),
        (PX4_COPTER, ["MAV_CMD 83", "MAV_CMD 31999", "NAV_DELAY"]),
    ],
    ids=["ardupilot", "px4"],
)
def test_commands_have_the_names_of_the_vehicles_dialect_and_others_their_number(
    monkeypatch, kind, names
) -> None:
    plan = PlanFile.of([MissionItem(number, param1=5) for number in (ALTITUDE_WAIT, UNKNOWN, DELAY)])
    held = []

    async def upload(_, sent, **options):
        held.append(sent)
        return sent

    async def download(_, **options):
        return held[-1]

    monkeypatch.setattr(VehiclePlan, "upload", upload)
    monkeypatch.setattr(VehiclePlan, "download", download)

    async def scenario(ground: Ground) -> None:
        path = "/api/vehicles/1/mission"
        text = format_plan(plan, "json").text
        for _ in range(2):  # as it is made, and as it was downloaded
            assert (await ground.api.put(path, data=text.encode())).status == 200
            found = (await ground.api.get(path)).json
            assert [each["name"] for each in found["mission"]] == names
            assert [each["command"] for each in found["mission"]] == [ALTITUDE_WAIT, UNKNOWN, DELAY]
            text = json.dumps(found)

    serve(kind, scenario, ready=False)


def test_files_that_are_no_plan_are_refused() -> None:
    async def scenario(ground: Ground) -> None:
        for data in (b"", b"hello", b"{}", b"\xff\xff"):
            answer = await ground.api.put("/api/vehicles/1/mission", data=data)
            assert (answer.status, answer.kind) == (400, "PlanFileError")
        unknown = await ground.api.get("/api/vehicles/1/mission?format=kml")
        assert unknown.problem == f"format must be one of {', '.join(sorted(FORMATS))}, got 'kml'"

    serve(COPTER, scenario, ready=False)


def test_a_plan_has_no_commands_beyond_the_role() -> None:
    """The vehicle would carry them out later: an operator could set parameters or reboot it by a mission."""
    passwords = {Role.OPERATE: "may fly it", Role.ADMINISTER: "may change it"}
    reboot = MissionItem(common.MavCmd.PREFLIGHT_REBOOT_SHUTDOWN, param1=1)
    plan = PlanFile.of([MissionItem.waypoint(*PLACES[0], 20.0), reboot])

    async def scenario(ground: Ground) -> None:
        data = format_plan(plan, "json").text.encode()
        for role, status in ((Role.OPERATE, 403), (Role.ADMINISTER, 409)):
            begun = await ground.api.post("/api/session", {"password": passwords[role]})
            ground.api.headers = {"authorization": f"Bearer {begun.json['token']}"}
            answer = await ground.api.put("/api/vehicles/1/mission", data=data)
            assert answer.status == status  # the simulated vehicle refuses it, too
            assert role is Role.ADMINISTER or "PREFLIGHT_REBOOT_SHUTDOWN" in answer.problem

    serve(COPTER, scenario, access=Access(passwords=passwords, local=False))
