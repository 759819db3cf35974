"""Tiles of maps in Web Mercator: the tiles of an area, and their number.

At zoom level z the world has 2**z by 2**z tiles; x counts from west to east, y from north to south. Source:
the slippy map tile names of the OpenStreetMap wiki, and OGC's WebMercatorQuad.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asinh, isfinite, pi, radians, tan
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.errors import InvalidArgumentError
from mavstack.geodesy import offset_location

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

MAX_ZOOM: Final = 22
#: Maximum bytes of a tile.
MAX_TILE: Final = 4 << 20
#: The latitude in degrees at which the square map of Web Mercator ends, north and south.
MAX_LATITUDE: Final = 85.051129
#: Maximum distance in metres from the centre of an area to its sides.
MAX_AROUND: Final = 500_000.0


class Tile(NamedTuple):
    """The place of a tile."""

    zoom: int
    x: int
    y: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Area:
    """A box of latitudes and longitudes in degrees; one across the antimeridian has `west` above `east`.

    Raises:
        InvalidArgumentError: A value is not a latitude or a longitude, or the box is empty.
    """

    south: float
    west: float
    north: float
    east: float

    def __post_init__(self) -> None:
        values = (self.south, self.west, self.north, self.east)
        if not all(map(isfinite, values)):
            raise InvalidArgumentError(f"the sides of an area must be finite, got {values}")
        if not -90 <= self.south < self.north <= 90:
            raise InvalidArgumentError(
                "the south of an area must be below its north, from -90 to 90, "
                f"got {self.south} and {self.north}"
            )
        if not (-180 <= self.west <= 180 and -180 <= self.east <= 180) or self.west == self.east:
            raise InvalidArgumentError(
                "the west and the east of an area must differ, from -180 to 180, "
                f"got {self.west} and {self.east}"
            )

    @classmethod
    def parse(cls, text: str) -> Area:
        """Return the area of a text such as `47.39,8.53,47.41,8.56`: south, west, north, east.

        Raises:
            InvalidArgumentError: The text is not four numbers, or they are not an area.
        """
        try:
            south, west, north, east = map(float, text.split(","))
        except ValueError:
            raise InvalidArgumentError(
                f"an area is four numbers of degrees, SOUTH,WEST,NORTH,EAST, got {text[:60]!r}"
            ) from None
        return cls(south=south, west=west, north=north, east=east)

    @classmethod
    def around(cls, latitude: float, longitude: float, distance: float) -> Area:
        """Return the square around a position, with its sides at some distance in metres.

        Raises:
            InvalidArgumentError: The position is not on Earth, or the distance is not positive.
        """
        if not (abs(latitude) <= 85 and abs(longitude) <= 180 and 0 < distance <= MAX_AROUND):
            raise InvalidArgumentError(
                "an area needs a latitude up to 85, a longitude up to 180 and up to "
                f"{MAX_AROUND:g} metres around them, got {latitude:g}, {longitude:g} and {distance:g}"
            )
        south, west = offset_location(latitude, longitude, -distance, -distance)
        north, east = offset_location(latitude, longitude, distance, distance)
        return cls(south=south, west=west, north=north, east=east)


def wrap_longitude(longitude: float) -> float:
    """Return a longitude in degrees from -180, inclusive, to 180."""
    return (longitude + 180) % 360 - 180


def tile_at(latitude: float, longitude: float, zoom: int) -> Tile:
    """Return the tile of a position in degrees; near the poles the last one."""
    x, y = place_at(latitude, longitude, zoom)
    last = (1 << zoom) - 1
    return Tile(zoom, min(max(int(x), 0), last), min(max(int(y), 0), last))


def place_at(latitude: float, longitude: float, zoom: int) -> tuple[float, float]:
    """Return a position in tiles from the north-western corner of the world, eastwards and southwards."""
    clamped = min(max(latitude, -MAX_LATITUDE), MAX_LATITUDE)
    edge = 1 << zoom
    return (longitude + 180) / 360 * edge, (1 - asinh(tan(radians(clamped))) / pi) / 2 * edge


def count_tiles(area: Area, zooms: Iterable[int]) -> int:
    """Return the number of tiles of an area at some zoom levels."""
    return sum(len(rows) * sum(map(len, columns)) for _, columns, rows in _grids(area, zooms))


def tiles_of(area: Area, zooms: Iterable[int]) -> Iterator[Tile]:
    """Yield the tiles of an area, the lowest zoom level first, so that a part of a download is of use."""
    for zoom, columns, rows in _grids(area, zooms):
        for y in rows:
            for part in columns:
                for x in part:
                    yield Tile(zoom, x, y)


def read_zooms(text: str) -> range:
    """Return the zoom levels of a text such as `10-16` or `14`.

    Raises:
        InvalidArgumentError: It is neither a number nor two, or they are out of range.
    """
    first, separator, last = text.partition("-")
    if not (first.isascii() and first.isdigit()) or (separator and not (last.isascii() and last.isdigit())):
        raise InvalidArgumentError(f"zoom levels are a number or two, such as 10-16, got {text[:20]!r}")
    return check_zooms(int(first[:4]), int((last or first)[:4]))


def check_zooms(lowest: int, highest: int) -> range:
    """Return the levels from the lowest to the highest one; raises `InvalidArgumentError` for none."""
    if not 0 <= lowest <= highest <= MAX_ZOOM:
        raise InvalidArgumentError(
            f"zoom levels are from 0 to {MAX_ZOOM}, the lowest first, got {lowest} to {highest}"
        )
    return range(lowest, highest + 1)


def _grids(area: Area, zooms: Iterable[int]) -> Iterator[tuple[int, list[range], range]]:
    """Yield zoom levels with their columns, in two parts across the antimeridian, and rows."""
    for zoom in sorted(set(zooms)):
        top, bottom = tile_at(area.north, area.west, zoom), tile_at(area.south, area.east, zoom)
        rows = range(top.y, bottom.y + 1)
        if area.west < area.east:
            columns = [range(top.x, bottom.x + 1)]
        elif bottom.x >= top.x:
            # The west and the east side are in the same column of tiles, so the area covers all columns.
            columns = [range(1 << zoom)]
        else:
            columns = [range(top.x, 1 << zoom), range(bottom.x + 1)]
        yield zoom, columns, rows
