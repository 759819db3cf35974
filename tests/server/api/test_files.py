from __future__ import annotations

from tests.server.stations import COPTER, Ground, serve


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
