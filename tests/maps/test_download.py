from __future__ import annotations

import asyncio
import threading

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.maps import Area, MapArchive, MapError, Pace, TileServer, count_tiles, download_area
from mavstack.maps.download import MAX_TRIES
from mavstack.maps.estimate import estimate_download
from mavstack.maps.tile_server import TileAnswer
from mavstack.maps.tiles import tiles_of
from mavstack.sim.virtual import run_virtually
from tests.maps.tile_pages import picture, tile_pages

AREA = Area(south=47.39, west=8.53, north=47.41, east=8.56)
ZOOMS = range(12, 16)
FAST = Pace(rate=200)
COUNT = count_tiles(AREA, ZOOMS)


class Scripted(TileServer):
    """A server without network: its answers come from a function."""

    def __init__(self, answer):
        super().__init__("https://tiles.example.org/{z}/{x}/{y}.png")
        self.answer = answer
        self.asked = []

    async def fetch(self, tile):
        self.asked.append(tile)
        return self.answer(tile)


def good(tile):
    return TileAnswer(picture(*tile)[1], "png")


def download(archive, server, **options):
    async def run():
        start = asyncio.get_running_loop().time()
        result = await download_area(archive, server, AREA, ZOOMS, **options)
        return result, asyncio.get_running_loop().time() - start

    return run_virtually(run())


def test_an_area_is_downloaded_and_a_second_download_adds_nothing(tmp_path):
    seen = []
    with tile_pages() as pages, MapArchive.create(tmp_path / "a.mbtiles") as archive:
        server = TileServer(pages.template)
        result = asyncio.run(
            download_area(archive, server, AREA, ZOOMS, pace=FAST, progress=lambda *step: seen.append(step))
        )
        assert (result.tiles, result.added, result.present, result.absent) == (COUNT, COUNT, 0, 0)
        assert seen[-1] == (COUNT, COUNT)
        assert all(archive.get(tile) == picture(*tile)[1] for tile in tiles_of(AREA, ZOOMS))
        again = asyncio.run(download_area(archive, server, AREA, ZOOMS, pace=FAST))
    assert (again.added, again.present) == (0, COUNT)
    assert len(pages.requested) == COUNT


def test_the_pace_is_kept(tmp_path):
    with MapArchive.create(tmp_path / "a.mbtiles") as archive:
        _, seconds = download(archive, Scripted(good), pace=Pace(rate=4, connections=2))
    assert seconds == pytest.approx((COUNT - 1) / 4, abs=0.01)


def test_an_interrupted_download_continues_where_it_ended(tmp_path):
    path = tmp_path / "a.mbtiles"
    server = Scripted(good)

    async def interrupted():
        with MapArchive.create(path) as archive:
            task = asyncio.create_task(download_area(archive, server, AREA, ZOOMS, pace=Pace(rate=10)))
            await asyncio.sleep(1.05)
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
            assert task.cancelled()

    run_virtually(interrupted())
    with MapArchive.create(path) as archive:
        kept = archive.facts().tiles
        assert kept == 11, "the tiles before the interruption are on disk"
        result, _ = download(archive, server, pace=FAST)
    assert (result.present, result.added) == (kept, COUNT - kept)


def test_a_busy_server_is_asked_again_after_its_time(tmp_path):
    left = [2]

    def answer(tile):
        left[0] -= 1
        return TileAnswer(retry_after=30.0, reason="503") if left[0] >= 0 else good(tile)

    with MapArchive.create(tmp_path / "a.mbtiles") as archive:
        result, seconds = download(archive, Scripted(answer), pace=FAST)
    assert result.added == COUNT
    assert 30 <= seconds < 70


def test_a_server_that_stays_busy_ends_the_download(tmp_path):
    server = Scripted(lambda tile: TileAnswer(retry_after=0.0, reason="503 Service Unavailable"))
    with (
        MapArchive.create(tmp_path / "a.mbtiles") as archive,
        pytest.raises(MapError, match=r"503 Service Unavailable; run it again later to continue"),
    ):
        download(archive, server, pace=Pace(rate=10, connections=1))
    assert len(server.asked) == MAX_TRIES


def test_tiles_that_the_server_does_not_have_are_counted(tmp_path):
    with MapArchive.create(tmp_path / "a.mbtiles") as archive:
        result, _ = download(
            archive, Scripted(lambda tile: TileAnswer() if tile.zoom > 13 else good(tile)), pace=FAST
        )
        assert result.absent == count_tiles(AREA, range(14, 16))
        assert result.done == COUNT
    with (
        MapArchive.create(tmp_path / "b.mbtiles") as archive,
        pytest.raises(MapError, match="it has no tile of the area at these zoom levels"),
    ):
        download(archive, Scripted(lambda tile: TileAnswer()), pace=FAST)


def test_limits(tmp_path):
    with MapArchive.create(tmp_path / "a.mbtiles") as archive:
        osm = TileServer("https://tile.openstreetmap.org/{z}/{x}/{y}.png")
        with pytest.raises(MapError, match="forbid the download of areas"):
            asyncio.run(download_area(archive, osm, AREA, ZOOMS))
        with pytest.raises(MapError, match="forbid the download of areas"):
            asyncio.run(estimate_download(osm, AREA, ZOOMS))
        world = Area(south=-80, west=-180, north=80, east=180)
        with pytest.raises(InvalidArgumentError, match="more than 500,000"):
            asyncio.run(download_area(archive, Scripted(good), world, ZOOMS))
    for wrong in (
        {"rate": 0},
        {"rate": 1000},
        {"rate": float("nan")},
        {"connections": 0},
        {"connections": 9},
    ):
        with pytest.raises(InvalidArgumentError, match=r"rate|connections"):
            Pace(**wrong)


def test_a_slow_disk_holds_up_a_thread_and_not_the_event_loop(tmp_path, monkeypatch):
    commit, threads = MapArchive.commit, []

    def noted(archive):
        threads.append((threading.current_thread(), archive._connection.in_transaction))
        commit(archive)

    monkeypatch.setattr(MapArchive, "commit", noted)
    with MapArchive.create(tmp_path / "a.mbtiles") as archive:
        download(archive, Scripted(good), pace=FAST)
    writing = [thread for thread, is_needed in threads if is_needed]
    assert writing
    assert threading.main_thread() not in writing
