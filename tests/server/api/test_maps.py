"""Maps of the station: list, tiles, estimate, download as a task, and removal."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

from mavstack.maps import Area, count_tiles
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.sim.virtual import run_virtually
from tests.maps.tile_pages import Pages, picture, tile_pages
from tests.server.asgi import ApiClient

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from pathlib import Path

BOX = {"south": 47.39, "west": 8.53, "north": 47.41, "east": 8.56}
COUNT = count_tiles(Area(**BOX), range(12, 15))


def serve(folder: Path | None, scenario: Callable[[ApiClient, Pages], Awaitable[None]]) -> None:
    """Run a scenario with a station and a server of tiles."""

    async def run() -> None:
        async with Station(maps=folder) as station:
            with tile_pages() as pages:
                await scenario(ApiClient(make_app(station, Access(), static=None)), pages)

    run_virtually(run())


def request(pages: Pages, **fields: Any) -> dict[str, Any]:
    zooms = {"min_zoom": 12, "max_zoom": 14, "rate": 200}
    return {"server": pages.template, **BOX, **zooms, **fields}


def test_a_map_is_downloaded_served_and_removed(tmp_path: Path) -> None:
    async def scenario(api: ApiClient, pages: Pages) -> None:
        assert (await api.get("/api/maps")).json == []
        estimate = (await api.post("/api/maps/field/estimate", request(pages))).json
        assert (estimate["tiles"], estimate["missing"], estimate["host"]) == (COUNT, COUNT, "127.0.0.1")
        answer = (await api.post("/api/maps/field", request(pages, attribution="© us"))).json
        assert (answer["added"], answer["map"]["attribution"]) == (COUNT, "© us")
        assert [each["name"] for each in (await api.get("/api/maps")).json] == ["field"]
        tile = await api.get("/api/maps/field/12/2145/1434")
        assert (tile.status, tile.headers["content-type"]) == (200, "image/png")
        assert tile.data == picture(12, 2145, 1434)[1]
        assert (await api.get("/api/maps/field/12/1/1")).status == 204
        for path in ("none/12/1/1", "field/12/4096/1", "field/-1/0/0", "field/99/0/0", "field/x/0/0"):
            assert (await api.get(f"/api/maps/{path}")).status == 404
        assert (await api.delete("/api/maps/field")).json == {"removed": "field"}
        assert (await api.delete("/api/maps/field")).status == 404

    serve(tmp_path, scenario)


def test_a_download_is_a_task_that_can_be_cancelled_and_continued(tmp_path: Path) -> None:
    async def scenario(api: ApiClient, pages: Pages) -> None:
        slow = request(pages, rate=1)
        started = (await api.post("/api/maps/field?wait=false", slow)).json
        task = f"/api/tasks/{started['task']}"

        async def done() -> int:
            return int((await api.get(task)).json["done"])

        while await done() < 3:  # noqa: ASYNC110 (the state is behind HTTP)
            await asyncio.sleep(0.2)
        assert (await api.post("/api/maps/field", slow)).status == 409, "one download at a time"
        assert (await api.delete("/api/maps/field")).status == 409
        await api.delete(task)
        answer = (await api.post("/api/maps/field", request(pages))).json
        assert answer["present"] >= 3
        assert answer["present"] + answer["added"] == COUNT

    serve(tmp_path, scenario)


def test_requests_that_are_refused(tmp_path: Path) -> None:
    async def scenario(api: ApiClient, pages: Pages) -> None:
        for fields in ({"server": "file:///{z}/{x}/{y}"}, {"north": 40}, {"max_zoom": 3}):
            assert (await api.post("/api/maps/field", request(pages, **fields))).status == 400
        osm = await api.post(
            "/api/maps/field", request(pages, server="https://tile.openstreetmap.org/{z}/{x}/{y}.png")
        )
        assert (osm.status, osm.kind) == (502, "MapError")

    serve(tmp_path, scenario)


def test_a_station_without_a_folder() -> None:
    async def scenario(api: ApiClient, pages: Pages) -> None:
        assert (await api.get("/api/maps")).json == []
        answer = await api.post("/api/maps/field", request(pages))
        assert (answer.status, "--maps FOLDER" in answer.problem) == (409, True)

    serve(None, scenario)
