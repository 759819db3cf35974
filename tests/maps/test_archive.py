from __future__ import annotations

import json
import sqlite3

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.maps import Area, MapArchive, MapError, Tile

AREA = Area(south=47.39, west=8.53, north=47.41, east=8.56)
TILE = Tile(3, 4, 2)


def test_tiles_are_kept_by_the_specification(tmp_path):
    path = tmp_path / "field.mbtiles"
    with MapArchive.create(path, attribution="© somebody") as archive:
        archive.extend(AREA, range(3, 6), "png")
        archive.put(TILE, b"\x89PNG one")
        archive.commit()
        assert TILE in archive
        assert Tile(3, 4, 5) not in archive
    with sqlite3.connect(path) as other:
        assert other.execute("SELECT * FROM tiles").fetchall() == [(3, 4, 5, b"\x89PNG one")]
        metadata = dict(other.execute("SELECT name, value FROM metadata"))
    other.close()
    assert metadata["bounds"] == "8.530000,47.390000,8.560000,47.410000"
    assert (metadata["name"], metadata["format"], metadata["minzoom"]) == ("field", "png", "3")
    with MapArchive.open(path) as archive:
        assert (archive.get(TILE), archive.get(Tile(3, 4, 3))) == (b"\x89PNG one", None)
        facts = archive.facts()
    assert (facts.name, facts.area, facts.min_zoom, facts.max_zoom) == ("field", AREA, 3, 5)
    assert (facts.attribution, facts.tiles, facts.size) == ("© somebody", 1, path.stat().st_size)


def test_an_archive_grows_by_further_areas(tmp_path):
    with MapArchive.create(tmp_path / "a.mbtiles") as archive:
        archive.extend(AREA, range(3, 6), "png")
        archive.extend(Area(south=46, west=8, north=47, east=8.55), range(1, 4), "png")
        facts = archive.facts()
        assert facts.area == Area(south=46, west=8, north=47.41, east=8.56)
        assert (facts.min_zoom, facts.max_zoom) == (1, 5)
        archive.extend(Area(south=1, west=179, north=2, east=-179), range(3, 4), "png")
        assert archive.facts().area == Area(south=1, west=-180, north=47.41, east=180)


def test_heights_and_pictures_are_not_mixed(tmp_path):
    path = tmp_path / "a.mbtiles"
    MapArchive.create(path, encoding="terrarium").close()
    MapArchive.create(path, encoding="terrarium").close()
    with pytest.raises(MapError, match="it holds terrarium, not pictures; take another name"):
        MapArchive.create(path)
    with pytest.raises(InvalidArgumentError, match="encodings of heights are terrarium and mapbox"):
        MapArchive.create(path, encoding="grey")


def test_archives_of_other_programs(tmp_path):
    path = tmp_path / "vectors.mbtiles"
    with sqlite3.connect(path) as other:
        other.execute("CREATE TABLE tiles (zoom_level, tile_column, tile_row, tile_data)")
        other.execute("INSERT INTO tiles VALUES (2, 1, 1, x'1f8b00')")
    with MapArchive.open(path) as archive:
        facts = archive.facts()
    assert (facts.format, facts.area, facts.min_zoom, facts.max_zoom) == ("", None, 2, 2)
    with sqlite3.connect(path) as other:
        other.execute("CREATE TABLE metadata (name, value)")
        layers = json.dumps({"vector_layers": [{"id": "water"}, {"id": "roads"}]})
        rows = [
            ("format", "pbf"),
            ("json", layers),
            ("bounds", "x,1"),
            ("maxzoom", "9999"),
            ("minzoom", "-1"),
        ]
        other.executemany("INSERT INTO metadata VALUES (?, ?)", rows)
    other.close()
    with MapArchive.open(path) as archive:
        facts = archive.facts()
        assert archive.average_size() is None
    assert (facts.format, facts.layers, facts.area, facts.max_zoom) == ("pbf", ("water", "roads"), None, 2)


def test_what_is_no_archive(tmp_path):
    with pytest.raises(MapError, match=r"reading .*none\.mbtiles failed: there is no such file"):
        MapArchive.open(tmp_path / "none.mbtiles")
    (tmp_path / "text.mbtiles").write_text("no database" * 100)
    with pytest.raises(MapError, match=r"reading .*text\.mbtiles failed: file is not a database"):
        MapArchive.open(tmp_path / "text.mbtiles")
    with pytest.raises(MapError, match=r"writing .*text\.mbtiles failed: file is not a database"):
        MapArchive.create(tmp_path / "text.mbtiles")
    with pytest.raises(MapError, match=r"writing .* failed: (Not a directory|File exists)"):
        MapArchive.create(tmp_path / "text.mbtiles" / "a.mbtiles")


@pytest.mark.parametrize("data", ["'text'", "9999999999999", "1.5", "NULL", "ZEROBLOB(4194305)"])
def test_data_that_is_not_a_tile(tmp_path, data):
    path = tmp_path / "a.mbtiles"
    with sqlite3.connect(path) as other:
        other.execute("CREATE TABLE tiles (zoom_level, tile_column, tile_row, tile_data)")
        other.executemany(
            f"INSERT INTO tiles VALUES (3, ?, 5, {data})", [(4,)] + [(each,) for each in range(20)]
        )
    other.close()
    with MapArchive.open(path) as archive:
        assert archive.get(TILE) is None
        assert (archive.average_size() is None) == (data == "NULL")


@pytest.mark.parametrize(("zoom", "lowest"), [("'x'", 0), ("x'ff'", 0), ("2.5", 0), ("-3", 0), ("99", 22)])
def test_zoom_levels_that_do_not_exist(tmp_path, zoom, lowest):
    path = tmp_path / "a.mbtiles"
    with sqlite3.connect(path) as other:
        other.execute("CREATE TABLE tiles (zoom_level, tile_column, tile_row, tile_data)")
        other.execute(f"INSERT INTO tiles VALUES ({zoom}, 1, 1, x'00')")
    other.close()
    with MapArchive.open(path) as archive:
        assert archive.facts().min_zoom == lowest


def test_vectors_and_pictures_are_not_mixed(tmp_path):
    with MapArchive.create(tmp_path / "a.mbtiles") as archive:
        archive.extend(AREA, range(3, 6), "png")
        archive.extend(AREA, range(3, 6), "jpg")
        with pytest.raises(MapError, match="it holds png tiles, which cannot be mixed with pbf tiles"):
            archive.extend(AREA, range(3, 6), "pbf")
