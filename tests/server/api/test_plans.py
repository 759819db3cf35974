from __future__ import annotations

import json

import pytest

from mavstack.dialects import common
from mavstack.files.plans import PlanFile, format_plan
from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.services.mission import MissionItem
from mavstack.sim.vehicle_types import DEFAULT_HOME as HOME
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


def test_files_that_are_no_plan_are_refused() -> None:
    async def scenario(ground: Ground) -> None:
        for data in (b"", b"hello", b"{}", b"\xff\xff"):
            answer = await ground.api.put("/api/vehicles/1/mission", data=data)
            assert (answer.status, answer.kind) == (400, "PlanFileError")
        unknown = await ground.api.get("/api/vehicles/1/mission?format=kml")
        assert unknown.problem == ("format must be one of json, plan, waypoints, rally, fence, got 'kml'")

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
