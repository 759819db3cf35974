"""MBTiles archives: tiles of a map in one SQLite file, by the specification of Mapbox (version 1.3).

Rows of tiles count from the south there. An archive of heights has the row `encoding` in its metadata, the
meaning of the colours of its pictures; other readers ignore it.
"""

from __future__ import annotations

import json
import sqlite3
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.maps.failures import MapError
from mavstack.maps.tiles import MAX_TILE, MAX_ZOOM, Area, Tile

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator
    from typing import Self

#: The encodings of heights in the colours of a tile: Terrarium by Mapzen, and Terrain-RGB by Mapbox.
ENCODINGS: Final = ("terrarium", "mapbox")
FORMATS: Final = ("png", "jpg", "webp", "pbf")
_SCHEMA: Final = """
CREATE TABLE IF NOT EXISTS metadata (name TEXT PRIMARY KEY, value TEXT);
CREATE TABLE IF NOT EXISTS tiles (
    zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER, tile_data BLOB,
    PRIMARY KEY (zoom_level, tile_column, tile_row)
) WITHOUT ROWID;
"""
#: Maximum characters of a metadata value and number of layers that are read, to limit the memory that a
#: damaged archive takes.
_MAX_TEXT: Final = 1 << 20
_MAX_LAYERS: Final = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class MapFacts:
    """The facts of an archive.

    Attributes:
        name: The name of the map.
        format: `png`, `jpg`, `webp` or `pbf` (vectors); empty: there are no tiles yet.
        encoding: `terrarium` or `mapbox` for heights; empty for pictures.
        attribution: The credit of the owner of the tiles.
        area: The area that the tiles cover; None: it is not known.
        min_zoom: The lowest zoom level.
        max_zoom: The highest zoom level.
        layers: The layers of vectors.
        tiles: The number of tiles.
        size: The size of the file in bytes.
    """

    name: str
    format: str = ""
    encoding: str = ""
    attribution: str = ""
    area: Area | None = None
    min_zoom: int = 0
    max_zoom: int = 0
    layers: tuple[str, ...] = ()
    tiles: int = 0
    size: int = 0


class MapArchive:
    """An archive of tiles, open; a context manager. `open` and `create` make one."""

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path = path
        self._connection = connection

    @classmethod
    def open(cls, path: str | os.PathLike[str]) -> Self:
        """Open an archive that exists, for reading.

        Raises:
            MapError: The file does not exist, or is not an archive of tiles.
        """
        place = Path(path)
        if not place.is_file():
            raise MapError(f"reading {place} failed: there is no such file")
        with _failures("reading", place):
            connection = sqlite3.connect(
                f"{place.absolute().as_uri()}?mode=ro", uri=True, check_same_thread=False
            )
        archive = cls(place, connection)
        try:
            with _failures("reading", place):
                connection.execute("SELECT tile_data FROM tiles LIMIT 1").fetchone()
        except MapError:
            archive.close()
            raise
        return archive

    @classmethod
    def create(cls, path: str | os.PathLike[str], *, attribution: str = "", encoding: str = "") -> Self:
        """Open an archive for writing; one that exists is continued.

        Args:
            path: The file; its stem is the name of the map.
            attribution: The credit of the owner of the tiles.
            encoding: `terrarium` or `mapbox` if the pictures are heights.

        Raises:
            InvalidArgumentError: The encoding is not known.
            MapError: The file cannot be written, or holds pictures where heights are wanted or the reverse.
        """
        if encoding and encoding not in ENCODINGS:
            raise InvalidArgumentError(
                f"encodings of heights are {' and '.join(ENCODINGS)}, got {encoding!r}"
            )
        place = Path(path)
        with _failures("writing", place):
            place.parent.mkdir(parents=True, exist_ok=True)
            connection = sqlite3.connect(place, check_same_thread=False)
        archive = cls(place, connection)
        try:
            archive._prepare(attribution, encoding)
        except MapError:
            archive.close()
            raise
        return archive

    def _prepare(self, attribution: str, encoding: str) -> None:
        with _failures("writing", self.path):
            self._connection.executescript(_SCHEMA)
            known = self._metadata()
            if known and known.get("encoding", "") != encoding:
                kind = known.get("encoding", "") or "pictures"
                raise MapError(
                    f"writing {self.path} failed: it holds {kind}, not {encoding or 'pictures'}; "
                    "take another name"
                )
            rows = {"name": self.path.stem, "type": "baselayer", "version": "1"}
            rows |= {"attribution": attribution} if attribution else {}
            rows |= {"encoding": encoding} if encoding else {}
            self._write_metadata(rows)

    def get(self, tile: Tile) -> bytes | None:
        """Return a tile; None if the archive does not have it, or its data cannot be a tile."""
        with _failures("reading", self.path):
            row = self._connection.execute(
                "SELECT tile_data FROM tiles WHERE zoom_level = ? AND tile_column = ? AND tile_row = ? "
                "AND TYPEOF(tile_data) = 'blob' AND LENGTH(tile_data) <= ?",
                (*_key(tile), MAX_TILE),
            ).fetchone()
        return (row[0] or None) if row is not None else None

    def __contains__(self, tile: Tile) -> bool:
        with _failures("reading", self.path):
            found = self._connection.execute(
                "SELECT 1 FROM tiles WHERE zoom_level = ? AND tile_column = ? AND tile_row = ?", _key(tile)
            )
            return found.fetchone() is not None

    def put(self, tile: Tile, data: bytes) -> None:
        """Store a tile; it is on disk after `commit`."""
        with _failures("writing", self.path):
            self._connection.execute("INSERT OR REPLACE INTO tiles VALUES (?, ?, ?, ?)", (*_key(tile), data))

    def commit(self) -> None:
        """Write the stored tiles to the disk."""
        with _failures("writing", self.path):
            self._connection.commit()

    def extend(self, area: Area, zooms: range, form: str) -> None:
        """Add an area and zoom levels to the facts of the archive.

        Raises:
            MapError: The archive holds pictures and the tiles are vectors or the reverse, or it cannot be
                written.
        """
        facts = self.facts()
        if facts.format and (facts.format == "pbf") != (form == "pbf"):
            raise MapError(
                f"writing {self.path} failed: it holds {facts.format} tiles, which cannot be mixed "
                f"with {form} tiles; take another name"
            )
        together = area if facts.area is None or not facts.format else _joined(facts.area, area)
        lowest, highest = zooms[0], zooms[-1]
        if facts.format:
            lowest, highest = min(lowest, facts.min_zoom), max(highest, facts.max_zoom)
        bounds = ",".join(
            f"{each:.6f}" for each in (together.west, together.south, together.east, together.north)
        )
        rows = {
            "bounds": bounds,
            "minzoom": str(lowest),
            "maxzoom": str(highest),
            "format": facts.format or form,
        }
        with _failures("writing", self.path):
            self._write_metadata(rows)

    def facts(self) -> MapFacts:
        """Return the facts of the archive."""
        with _failures("reading", self.path):
            rows = self._metadata()
            count, lowest, highest = self._connection.execute(
                "SELECT COUNT(*), MIN(zoom_level), MAX(zoom_level) FROM tiles"
            ).fetchone()
        facts = MapFacts(
            name=self.path.stem,
            format=rows.get("format", "").lower().replace("jpeg", "jpg"),
            encoding=rows.get("encoding", "") if rows.get("encoding") in ENCODINGS else "",
            attribution=rows.get("attribution", ""),
            area=_area(rows.get("bounds", "")),
            layers=_layers(rows.get("json", "")),
            min_zoom=_zoom(rows.get("minzoom"), lowest),
            max_zoom=_zoom(rows.get("maxzoom"), highest),
            tiles=count,
        )
        with suppress(OSError):
            return replace(facts, size=self.path.stat().st_size)
        return facts

    def average_size(self) -> float | None:
        """Return the mean bytes of the tiles; None if there are fewer than twenty."""
        with _failures("reading", self.path):
            count, size = self._connection.execute(
                "SELECT COUNT(*), AVG(LENGTH(tile_data)) FROM (SELECT tile_data FROM tiles LIMIT 2000)"
            ).fetchone()
        return None if count < 20 or size is None else float(size)

    def close(self) -> None:
        """Close the file; tiles after the last `commit` are lost. Idempotent."""
        self._connection.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _metadata(self) -> dict[str, str]:
        try:
            rows = self._connection.execute(
                "SELECT name, substr(value, 1, ?) FROM metadata LIMIT 100", (_MAX_TEXT,)
            )
            return {str(name): str(value) for name, value in rows}
        except sqlite3.OperationalError:  # archives of other programs may lack the table
            return {}

    def _write_metadata(self, rows: dict[str, str]) -> None:
        self._connection.executemany("INSERT OR REPLACE INTO metadata VALUES (?, ?)", rows.items())
        self._connection.commit()


@contextmanager
def _failures(operation: str, path: Path) -> Iterator[None]:
    """Turn errors of the file into `MapError`."""
    try:
        yield
    except sqlite3.Error as error:
        raise MapError(f"{operation} {path} failed: {error}") from None
    except OSError as error:
        raise MapError(f"{operation} {path} failed: {error.strerror or error}") from None


def _key(tile: Tile) -> tuple[int, int, int]:
    return tile.zoom, tile.x, (1 << tile.zoom) - 1 - tile.y


def _zoom(text: str | None, found: object) -> int:
    """Return a zoom level of the metadata, or the one of the tiles that are there."""
    if text is not None and text.isascii() and text.isdigit() and len(text) < 3:
        found = int(text)
    return min(max(found, 0), MAX_ZOOM) if isinstance(found, int) else 0


def _area(text: str) -> Area | None:
    """Return the area of the row `bounds`: west, south, east, north."""
    with suppress(ValueError, InvalidArgumentError):
        west, south, east, north = map(float, text.split(","))
        return Area(south=south, west=west, north=north, east=east)
    return None


def _layers(text: str) -> tuple[str, ...]:
    with suppress(ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return tuple(str(each["id"]) for each in json.loads(text)["vector_layers"][:_MAX_LAYERS])
    return ()


def _joined(first: Area, second: Area) -> Area:
    """Return a box around two areas."""
    south, north = min(first.south, second.south), max(first.north, second.north)
    if first.west > first.east or second.west > second.east:
        return Area(south=south, west=-180, north=north, east=180)
    return Area(
        south=south, west=min(first.west, second.west), north=north, east=max(first.east, second.east)
    )
