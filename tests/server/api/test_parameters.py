from __future__ import annotations

from tests.server.stations import COPTER, Ground, serve


def test_parameters_are_downloaded_read_and_set() -> None:
    async def scenario(ground: Ground) -> None:
        found = (await ground.api.get("/api/vehicles/1/parameters")).json["parameters"]
        names = [each["name"] for each in found]
        assert len(names) > 100
        assert names == sorted(names)
        one = (await ground.api.get("/api/vehicles/1/parameters/RTL_ALT")).json
        assert one == next(each for each in found if each["name"] == "RTL_ALT")
        changed = await ground.api.put("/api/vehicles/1/parameters/RTL_ALT", {"value": 2500})
        assert (changed.status, changed.json["value"]) == (200, 2500)
        cached = (await ground.api.get("/api/vehicles/1/parameters?cached=true")).json["parameters"]
        assert {each["name"]: each["value"] for each in cached}["RTL_ALT"] == 2500

    serve(COPTER, scenario)


def test_wrong_values_and_unknown_names() -> None:
    async def scenario(ground: Ground) -> None:
        wrong = await ground.api.put("/api/vehicles/1/parameters/RTL_ALT", {"value": "high"})
        assert (wrong.status, wrong.problem) == (400, "value must be a number, got 'high'")
        missing = await ground.api.put("/api/vehicles/1/parameters/RTL_ALT")
        assert (missing.status, missing.kind) == (415, "UnsupportedMediaType")
        unknown = await ground.api.get("/api/vehicles/1/parameters/NO_SUCH")
        assert unknown.status in (409, 504)

    serve(COPTER, scenario)
