from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.maps.tiles import Area, Tile, count_tiles, read_zooms, tile_at, tiles_of

FIELD = Area(south=47.39, west=8.53, north=47.41, east=8.56)


def test_known_tiles():
    """Tiles of the wiki of OpenStreetMap and of the whole world."""
    assert tile_at(47.3977, 8.5456, 0) == Tile(0, 0, 0)
    assert tile_at(51.51202, 0.02435, 17) == Tile(17, 65544, 43582)
    assert tile_at(-90, -180, 3) == Tile(3, 0, 7)
    assert tile_at(90, 180, 3) == Tile(3, 7, 0)


def test_an_area_has_the_tiles_between_its_corners():
    tiles = list(tiles_of(FIELD, range(10, 13)))
    assert len(tiles) == len(set(tiles)) == count_tiles(FIELD, range(10, 13))
    assert tiles[0].zoom == 10
    assert {tile_at(47.391, 8.531, 12), tile_at(47.409, 8.559, 12)} <= set(tiles)


def test_an_area_across_the_antimeridian():
    fiji = Area(south=-17, west=179, north=-16, east=-179)
    columns = {tile.x for tile in tiles_of(fiji, [8])}
    assert columns == {255, 0}
    assert count_tiles(fiji, [0]) == 1
    assert count_tiles(Area(south=-1, west=10.2, north=1, east=10.1), [1]) == 4, "around the whole Earth"


@given(
    st.floats(-84, 84), st.floats(-180, 180), st.floats(0.001, 0.5), st.floats(0.001, 0.5), st.integers(0, 12)
)
def test_each_position_of_an_area_is_in_one_of_its_tiles(south, west, height, width, zoom):
    east = (west + width + 180) % 360 - 180
    area = Area(south=south, west=west, north=south + height, east=east)
    tiles = set(tiles_of(area, [zoom]))
    assert len(tiles) == count_tiles(area, [zoom])
    for part in (0.0, 0.5, 1.0):
        longitude = (west + width * part + 180) % 360 - 180
        assert tile_at(south + height * part, longitude, zoom) in tiles


def test_areas_around_a_place():
    area = Area.around(47.4, 8.5, 1000)
    assert (area.north - area.south) * 111_200 == pytest.approx(2000, rel=0.01)
    across = Area.around(0, 180, 1000)
    assert across.west > across.east
    for wrong in ((86, 0, 10), (0, 181, 10), (0, 0, 0), (0, 0, float("nan"))):
        with pytest.raises(InvalidArgumentError, match="an area needs"):
            Area.around(*wrong)


@pytest.mark.parametrize(
    "text", ["", "1,2,3", "a,b,c,d", "3,1,2,4", "1,9,2,9", "nan,1,2,3", "-91,1,2,3", "1,2,3,400"]
)
def test_what_is_no_area(text):
    with pytest.raises(InvalidArgumentError, match="area"):
        Area.parse(text)


def test_zoom_levels():
    assert (read_zooms("10-16"), read_zooms("7")) == (range(10, 17), range(7, 8))
    for text in ("", "x", "-3", "5-", "9-8", "3-23", "99999999999"):
        with pytest.raises(InvalidArgumentError, match="zoom levels"):
            read_zooms(text)
