from __future__ import annotations

import shutil

from mavstack.security.roles import Role
from mavstack.server.access import Access
from tests.docs.blocks import ROOT
from tests.server.stations import COPTER, Ground, serve

PASSWORDS = {Role.OPERATE: "may fly it", Role.ADMINISTER: "may do it all"}


def test_sources_are_listed_added_and_removed() -> None:
    async def scenario(ground: Ground) -> None:
        (first,) = (await ground.api.get("/api/sources")).json
        assert (first["id"], first["state"]) == ("1", "connected")
        removed = await ground.api.delete("/api/sources/1")
        assert (removed.status, removed.json["state"]) == (200, "closed")
        vehicle = ground.station.vehicle(1)
        await ground.wait_until(lambda: not vehicle.alive)
        await ground.station.sources.add(ground.network.link())
        await ground.wait_until(lambda: vehicle.alive)
        assert [each["id"] for each in (await ground.api.get("/api/sources")).json] == ["2"]
        assert (await ground.api.delete("/api/sources/1")).status == 404
        wrong = await ground.api.post("/api/sources", {"url": "nonsense"})
        assert (wrong.status, wrong.kind) == (400, "LinkURLError")

    serve(COPTER, scenario)


def test_long_work_runs_as_a_task_with_progress() -> None:
    async def scenario(ground: Ground) -> None:
        started = (await ground.api.get("/api/vehicles/1/parameters?wait=false")).json
        assert started == {"task": "1", "progress": "/api/tasks/1/progress", "result": "/api/tasks/1/result"}
        early = await ground.api.get(started["result"])
        assert (early.status, early.problem) == (409, "the task 1 is running: it has no result")
        text = (await ground.api.get(started["progress"])).data.decode()
        events = [block.splitlines()[0] for block in text.strip().split("\n\n")]
        assert events[-1] == "event: done"
        assert set(events[:-1]) == {"event: progress"}
        assert len((await ground.api.get(started["result"])).json["parameters"]) > 100
        (listed,) = (await ground.api.get("/api/tasks")).json
        assert (listed["state"], listed["done"], listed["name"]) == (
            "done",
            listed["total"],
            "GET /api/vehicles/1/parameters",
        )

    serve(COPTER, scenario)


def test_a_task_is_cancelled_and_a_failure_is_kept() -> None:
    async def scenario(ground: Ground) -> None:
        await ground.api.get("/api/vehicles/1/parameters?wait=false")
        assert (await ground.api.delete("/api/tasks/1")).json["state"] == "cancelled"
        assert (await ground.api.get("/api/tasks/1")).status == 404
        await ground.api.post("/api/vehicles/1/arm?wait=false", {})
        text = (await ground.api.get("/api/tasks/2/progress")).data.decode()
        assert "event: failed" in text
        assert (await ground.api.get("/api/tasks/2")).json["error"]["kind"] == "CommandDenied"
        assert (await ground.api.get("/api/tasks/2/result")).status == 409

    serve(COPTER, scenario, ready=False)


def test_tasks_of_other_sessions_are_hidden() -> None:
    async def scenario(ground: Ground) -> None:
        async def session(role: Role) -> dict[str, str]:
            began = await ground.api.post("/api/session", {"password": PASSWORDS[role]})
            return {"authorization": f"Bearer {began.json['token']}"}

        own, other, above = [await session(role) for role in (Role.OPERATE, Role.OPERATE, Role.ADMINISTER)]
        await ground.api.get("/api/vehicles/1/parameters?wait=false", headers=own)
        seen = [(await ground.api.get("/api/tasks/1", headers=each)).status for each in (own, other, above)]
        assert seen == [200, 404, 200]
        assert (await ground.api.get("/api/tasks", headers=other)).json == []

    serve(COPTER, scenario, access=Access(passwords=PASSWORDS, local=False))


def test_statistics() -> None:
    async def scenario(ground: Ground) -> None:
        found = (await ground.api.get("/api/statistics")).json
        assert found["packets"] > 0
        (channel,) = found["channels"]
        assert channel["sources"]["1/1"]["received"] > 0

    serve(COPTER, scenario)


def test_a_recording_is_replayed_as_a_source(tmp_path) -> None:
    shutil.copy(ROOT / "tests" / "recordings" / "flight.tlog", tmp_path / "a flight.tlog")

    async def scenario(ground: Ground) -> None:
        api = ground.api
        added = await api.post("/api/sources", {"recording": "a flight.tlog", "speed": 100})
        assert (added.status, added.json["url"].startswith("file:")) == (201, True)
        await ground.wait_until(lambda: ground.station.connection.vehicles)
        await ground.wait_until(lambda: ground.station.sources.find("2").state == "ended", timeout=600)
        wrong = await api.post("/api/sources", {"recording": "a flight.tlog", "url": "udpin://:0"})
        assert (wrong.status, wrong.problem) == (400, "either a url or a recording is needed")
        assert (await api.post("/api/sources", {"recording": "../flight.tlog"})).status == 400

    serve((), scenario, folder=tmp_path)
