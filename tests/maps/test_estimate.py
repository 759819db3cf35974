from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.maps import (
    Area,
    MapArchive,
    MapError,
    TileServer,
    count_tiles,
    download_area,
    estimate_download,
)
from mavstack.maps.download import Pace
from mavstack.maps.estimate import DEFAULT_SIZE, samples
from mavstack.maps.tiles import tiles_of
from tests.maps.tile_pages import picture, tile_pages

AREA = Area(south=47.39, west=8.53, north=47.41, east=8.56)
ZOOMS = range(12, 16)
COUNT = count_tiles(AREA, ZOOMS)
SIZE = len(picture(14, 1, 1)[1])


def estimate(pages, archive=None):
    return asyncio.run(estimate_download(TileServer(pages.template), AREA, ZOOMS, archive, rate=10))


def test_a_few_tiles_give_the_size():
    with tile_pages() as pages:
        found = estimate(pages)
    assert (found.tiles, found.missing, found.seconds) == (COUNT, COUNT, COUNT / 10)
    assert found.bytes == pytest.approx(COUNT * SIZE, rel=0.1)
    assert 1 <= len(pages.requested) <= 4


def test_tiles_of_the_archive_are_subtracted(tmp_path):
    with tile_pages() as pages, MapArchive.create(tmp_path / "a.mbtiles") as archive:
        server, rest = TileServer(pages.template), count_tiles(AREA, [15])
        asyncio.run(download_area(archive, server, AREA, range(12, 15), pace=Pace(rate=200)))
        found = estimate(pages, archive)
        assert (found.tiles, found.missing) == (COUNT, rest)
        asyncio.run(download_area(archive, server, AREA, ZOOMS, pace=Pace(rate=200)))
        before = len(pages.requested)
        assert (estimate(pages, archive).bytes, len(pages.requested)) == (0, before)


def test_servers_that_give_no_samples():
    with tile_pages(lambda *_: (404, b"", {})) as pages:
        assert estimate(pages).bytes == COUNT * DEFAULT_SIZE
        pages.answer = lambda *_: (503, b"", {})
        with pytest.raises(MapError, match="failed: 503 Service Unavailable"):
            estimate(pages)


@pytest.mark.parametrize("rate", [0.0, -1.0, float("nan")])
def test_a_rate_must_be_positive(rate):
    server = TileServer("https://tiles.example.org/{z}/{x}/{y}.png")
    with pytest.raises(InvalidArgumentError, match="the rate must be positive"):
        asyncio.run(estimate_download(server, AREA, ZOOMS, rate=rate))


def test_samples_are_in_the_area():
    for area in (AREA, Area(south=-1, west=179.9, north=1, east=-179.9)):
        assert set(samples(area, 16)) <= set(tiles_of(area, [16]))
