from __future__ import annotations

from io import BytesIO
from math import nan

import pytest

from mavstack.maps import Area, MapArchive, MapError
from mavstack.maps.tiles import tile_at
from tests.maps.tile_pages import png

pytest.importorskip("PIL")

from PIL import Image

from mavstack.maps.heights import TileHeights

PLACE = (47.3977, 8.5456)
ZOOM = 12
AREA = Area(south=47.3, west=8.5, north=47.5, east=8.6)


def terrarium(height: float) -> tuple[int, int, int]:
    value = round((height + 32_768) * 256)
    return value >> 16, value >> 8 & 255, value & 255


def mapbox(height: float) -> tuple[int, int, int]:
    value = round((height + 10_000) * 10)
    return value >> 16, value >> 8 & 255, value & 255


def heights_of(tmp_path, data, encoding="terrarium"):
    path = tmp_path / "heights.mbtiles"
    with MapArchive.create(path, encoding=encoding) as archive:
        archive.extend(AREA, range(ZOOM, ZOOM + 1), "png")
        archive.put(tile_at(*PLACE, ZOOM), data)
        archive.commit()
    return TileHeights(path)


@pytest.mark.parametrize(
    ("encoding", "colour"), [("terrarium", terrarium), ("mapbox", mapbox)], ids=["terrarium", "mapbox"]
)
def test_heights_by_both_encodings(tmp_path, encoding, colour):
    with heights_of(tmp_path, png([[colour(487.5)] * 256] * 256), encoding) as heights:
        assert heights(*PLACE) == pytest.approx(487.5, abs=0.1)
        assert heights(47.3977, 9.5) is None, "a tile that is not there"
        assert heights(PLACE[0], PLACE[1] + 360) == pytest.approx(487.5, abs=0.1)
        assert heights(PLACE[0], PLACE[1] - 360) == pytest.approx(487.5, abs=0.1)
        assert heights(nan, 8.5) is None
        assert heights(89.0, 8.5) is None


def test_heights_between_the_points(tmp_path):
    """The ground rises by a metre per column, and by two per row to the south."""
    rows = [[terrarium(column + 2 * row) for column in range(256)] for row in range(256)]
    with heights_of(tmp_path, png(rows)) as heights:
        tile = tile_at(*PLACE, ZOOM)
        west = tile.x / 2**ZOOM * 360 - 180
        step = 360 / 2**ZOOM / 256
        middle = heights(PLACE[0], west + 100.5 * step)
        assert heights(PLACE[0], west + 101 * step) == pytest.approx(middle + 0.5, abs=0.01)
        assert heights(PLACE[0] - 0.001, west + 100.5 * step) > middle


def test_unknown_and_damaged_tiles(tmp_path, caplog):
    with heights_of(tmp_path, png([[(0, 0, 0)] * 4] * 4)) as heights:
        assert heights(*PLACE) is None
    (tmp_path / "heights.mbtiles").unlink()
    with heights_of(tmp_path, b"\x89PNG damaged") as heights:
        assert heights(*PLACE) is None
    assert "a tile of heights is damaged" in caplog.text


def test_only_formats_of_maps_are_decoded(tmp_path, caplog):
    picture = BytesIO()
    Image.new("RGB", (4, 4)).save(picture, "PPM")
    with heights_of(tmp_path, picture.getvalue()) as heights:
        assert heights(*PLACE) is None
    assert "cannot identify image file" in caplog.text


def test_pictures_are_not_heights(tmp_path):
    MapArchive.create(tmp_path / "a.mbtiles").close()
    with pytest.raises(MapError, match="its pictures are not heights"):
        TileHeights(tmp_path / "a.mbtiles")
