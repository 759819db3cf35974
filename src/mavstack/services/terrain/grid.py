"""The grid of the terrain protocol: blocks of tiles of points.

    point   one height, `spacing` metres from the next
    tile    4 x 4 points, the content of one TERRAIN_DATA
    block   8 tiles eastward x 7 tiles northward, the subject of one TERRAIN_REQUEST

Both messages name a block by its south-western corner. Tiles are numbered from there, eastward first: tile =
east + 8 · north, and so are the points of a tile (point = east + 4 · north).

A vehicle divides each square degree into blocks from its south-western corner on. Neighbouring blocks share
one tile, so that each position lies between four points of one block. Metres become degrees on a sphere, with
the longitudes of the mean latitude. Source: guide, Terrain Protocol; ArduPilot, libraries/AP_Terrain.
"""

from __future__ import annotations

from math import cos, floor, radians
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.geodesy import ARDUPILOT_RADIUS

if TYPE_CHECKING:
    from collections.abc import Iterator

#: The number of points along an edge of a tile, and in a tile.
TILE_EDGE: Final = 4
TILE_POINTS: Final = TILE_EDGE * TILE_EDGE
#: The number of tiles of a block.
TILES_EAST, TILES_NORTH = 8, 7
TILES: Final = TILES_EAST * TILES_NORTH
#: The mask of a TERRAIN_REQUEST for all tiles of a block.
ALL_TILES: Final = (1 << TILES) - 1
#: The number of points of a block.
POINTS_EAST, POINTS_NORTH = TILES_EAST * TILE_EDGE, TILES_NORTH * TILE_EDGE
#: The number of points from one block to the next: neighbouring blocks overlap by one tile.
STEP_EAST, STEP_NORTH = POINTS_EAST - TILE_EDGE, POINTS_NORTH - TILE_EDGE
#: Default of the distance between two points, in metres.
DEFAULT_SPACING: Final = 100

#: Metres per 1e-7 degree of latitude on ArduPilot's earth radius, so that blocks are where ArduPilot looks
#: for them.
_METRES: Final = radians(1e-7) * ARDUPILOT_RADIUS
_DEGREE: Final = 10_000_000
_HALF_TURN: Final = 180 * _DEGREE
#: The smallest cosine of the latitude that is used: at a pole there is no east.
_MIN_COSINE: Final = 0.01


class Block(NamedTuple):
    """A block of the grid: its south-western corner in 1e-7 degrees, and its spacing in metres."""

    latitude: int
    longitude: int
    spacing: int

    @property
    def is_valid(self) -> bool:
        """True if the corner is on Earth and the spacing positive."""
        on_earth = abs(self.latitude) <= _HALF_TURN // 2 and abs(self.longitude) <= _HALF_TURN
        return on_earth and self.spacing > 0

    def tile_positions(self, tile: int) -> Iterator[tuple[float, float]]:
        """Yield latitude and longitude in degrees of the points of a tile, in the order of TERRAIN_DATA."""
        first_north, first_east = (each * TILE_EDGE for each in divmod(tile, TILES_EAST))
        for point in range(TILE_POINTS):
            north, east = divmod(point, TILE_EDGE)
            yield self.position_of(first_north + north, first_east + east)

    def position_of(self, north: int, east: int) -> tuple[float, float]:
        """Return latitude and longitude in degrees of a point of the block, counted from the corner."""
        metres = north * self.spacing, east * self.spacing
        latitude, longitude = _moved(self.latitude, self.longitude, *metres)
        return latitude / _DEGREE, longitude / _DEGREE


class GridPlace(NamedTuple):
    """A position in the grid: the point south-west of it, and the shares of the way to the next points."""

    block: Block
    north: int
    east: int
    north_share: float
    east_share: float


def locate(latitude: float, longitude: float, spacing: int) -> GridPlace:
    """Return the place of a position in the grid.

    Args:
        latitude: Degrees.
        longitude: Degrees.
        spacing: Metres between two points.
    """
    here = round(latitude * _DEGREE), round(longitude * _DEGREE)
    corner = floor(here[0] / _DEGREE) * _DEGREE, floor(here[1] / _DEGREE) * _DEGREE
    north = (here[0] - corner[0]) * _METRES / spacing
    east = (here[1] - corner[1]) * _METRES * _cosine((here[0] + corner[0]) / 2) / spacing
    block_north, point_north = divmod(int(north), STEP_NORTH)
    block_east, point_east = divmod(int(east), STEP_EAST)
    start = _moved(*corner, block_north * STEP_NORTH * spacing, block_east * STEP_EAST * spacing)
    return GridPlace(Block(*start, spacing), point_north, point_east, north % 1.0, east % 1.0)


def moved(latitude: float, longitude: float, north: float, east: float) -> tuple[float, float]:
    """Return the position in degrees that is `north` and `east` metres from one in degrees."""
    result = _moved(round(latitude * _DEGREE), round(longitude * _DEGREE), north, east)
    return result[0] / _DEGREE, result[1] / _DEGREE


def _moved(latitude: int, longitude: int, north: float, east: float) -> tuple[int, int]:
    """Return a position in 1e-7 degrees, moved by metres; no further than the pole."""
    to_latitude = latitude + int(north / _METRES)
    cosine = _cosine((latitude + to_latitude) / 2)
    to_longitude = longitude + int(east / _METRES / cosine)
    wrapped = (to_longitude + _HALF_TURN) % (2 * _HALF_TURN) - _HALF_TURN
    return min(max(to_latitude, -_HALF_TURN // 2), _HALF_TURN // 2), wrapped


def _cosine(latitude: float) -> float:
    return max(cos(radians(latitude / _DEGREE)), _MIN_COSINE)
