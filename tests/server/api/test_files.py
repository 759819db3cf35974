from __future__ import annotations

from typing import TYPE_CHECKING

from tests.server.stations import COPTER, Ground, serve

if TYPE_CHECKING:
    from pathlib import Path


def test_files_are_listed_uploaded_downloaded_and_removed() -> None:
    async def scenario(ground: Ground) -> None:
        listed = (await ground.api.get("/api/vehicles/1/files?path=/")).json
        assert listed["path"] == "/"
        assert listed["entries"]
        path = "/api/vehicles/1/files/a.lua"
        assert (await ground.api.put(path, data=b"return 1\n")).json == {"path": "/a.lua", "size": 9}
        found = await ground.api.get(path)
        assert (found.status, found.data) == (200, b"return 1\n")
        assert found.headers["content-disposition"] == 'attachment; filename="a.lua"'
        assert (await ground.api.delete(path)).status == 200
        missing = await ground.api.get(path)
        assert (missing.status, missing.kind) == (409, "FileDenied")

    serve(COPTER, scenario)


def test_a_log_is_kept_at_the_station_for_its_report(tmp_path: Path) -> None:
    async def scenario(ground: Ground) -> None:
        await ground.api.post("/api/vehicles/1/mode", {"mode": "GUIDED"})
        await ground.api.post("/api/vehicles/1/arm")
        await ground.api.post("/api/vehicles/1/disarm", {"force": True})
        number = (await ground.api.get("/api/vehicles/1/logs")).json["logs"][0]["id"]
        kept = await ground.api.post(f"/api/vehicles/1/logs/{number}")
        assert (kept.status, kept.json["running"]) == (201, False)
        again = (await ground.api.post(f"/api/vehicles/1/logs/{number}")).json
        assert kept.json["name"].startswith(f"vehicle-1-log-{number}")
        assert again["size"] >= kept.json["size"] > 0
        # The later copy has taken the place of the first one, and no part of it is left.
        assert [each.name for each in folder.iterdir()] == [kept.json["name"]] == [again["name"]]
        assert [each["name"] for each in (await ground.api.get("/api/recordings")).json] == [again["name"]]
        report = await ground.api.get(f"/api/reports/{again['name']}")
        assert (report.status, b"<html" in report.data) == (200, True)
        assert (await ground.api.post("/api/vehicles/1/logs/9999")).status == 404

    folder = tmp_path / "new"
    serve(COPTER, scenario, folder=folder)


def test_a_log_that_cannot_be_kept_is_reported(tmp_path: Path) -> None:
    async def scenario(ground: Ground) -> None:
        await ground.api.post("/api/vehicles/1/mode", {"mode": "GUIDED"})
        await ground.api.post("/api/vehicles/1/arm")
        number = (await ground.api.get("/api/vehicles/1/logs")).json["logs"][0]["id"]
        refused = await ground.api.post(f"/api/vehicles/1/logs/{number}")
        assert (refused.status, refused.kind) == (409, "LogError")

    file = tmp_path / "file"
    file.touch()
    serve(COPTER, scenario, folder=file)


def test_logs_are_listed_and_downloaded() -> None:
    async def scenario(ground: Ground) -> None:
        await ground.api.post("/api/vehicles/1/mode", {"mode": "GUIDED"})
        await ground.api.post("/api/vehicles/1/arm")
        await ground.api.post("/api/vehicles/1/disarm", {"force": True})
        logs = (await ground.api.get("/api/vehicles/1/logs")).json["logs"]
        assert logs
        assert logs[0]["size"] > 0
        found = await ground.api.get(f"/api/vehicles/1/logs/{logs[0]['id']}")
        assert found.status == 200
        assert abs(len(found.data) - logs[0]["size"]) < 10_000
        assert found.headers["content-disposition"].endswith('.bin"')
        for number in ("9999", "x", "-1", "123456"):
            assert (await ground.api.get(f"/api/vehicles/1/logs/{number}")).status == 404

    serve(COPTER, scenario)
