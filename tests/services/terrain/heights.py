"""A landscape for tests: hills of some hundred metres, as a function and as a map that has all of it."""

from __future__ import annotations

from math import cos, radians, sin

from mavstack.dialects import common
from mavstack.services.terrain import TerrainMap
from tests.services.network import GROUND, VEHICLE
from tests.services.single_service import packet_of

PLACE = (47.3977, 8.5456)


def hills(latitude: float, longitude: float) -> float:
    """Return a height in metres; it changes by up to a fifth of the distance."""
    return 500 + 100 * sin(radians(latitude * 6000)) + 80 * cos(radians(longitude * 5000))


def request(block, mask: int = 1, source=VEHICLE):
    """Return TERRAIN_REQUEST as received."""
    return packet_of(common.TerrainRequest(*block, mask=mask), source)


def data(block, tile: int = 0, heights=range(16), source=GROUND):
    """Return TERRAIN_DATA as received."""
    return packet_of(common.TerrainData(*block, gridbit=tile, data=list(heights)), source)


def filled_map(*positions, heights=hills) -> TerrainMap:
    """Return a map with the whole blocks of some positions."""
    terrain = TerrainMap()
    for position in positions:
        terrain.want(*position)
    for block in list(terrain.incomplete()):
        for tile in range(56):
            terrain.store(block, tile, [round(heights(*place)) for place in block.tile_positions(tile)])
    return terrain
