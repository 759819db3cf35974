from __future__ import annotations

from math import nan

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.services.terrain import Block, TerrainMap, locate, moved
from mavstack.services.terrain.map import MAX_BLOCKS
from tests.services.terrain.heights import PLACE, filled_map, hills


def test_heights_are_those_of_the_landscape():
    terrain = filled_map(PLACE)
    assert terrain.height(*PLACE) == pytest.approx(hills(*PLACE), abs=4)
    assert terrain.height(*moved(*PLACE, 50, 70)) == pytest.approx(hills(*moved(*PLACE, 50, 70)), abs=4)
    assert terrain.height(*moved(*PLACE, 20_000, 0)) is None
    assert terrain.height(nan, 8.0) is None


def test_between_the_points_heights_are_linear():
    terrain = TerrainMap()
    terrain.want(47.0, 8.0)
    block = locate(47.0, 8.0, 100).block
    terrain.store(block, 0, [10 * east + 100 * north for north in range(4) for east in range(4)])
    latitude, longitude = block.position_of(1, 1)
    next_latitude, next_longitude = block.position_of(2, 2)
    middle = (latitude + next_latitude) / 2, (longitude + next_longitude) / 2
    assert terrain.height(*middle) == pytest.approx(165, abs=0.1)


def test_all_four_points_must_be_known():
    terrain = TerrainMap()
    terrain.want(47.0, 8.0)
    block = locate(47.0, 8.0, 100).block
    terrain.store(block, 0, [7] * 16)
    inside, edge = (moved(47.0, 8.0, 150, east) for east in (150, 350))
    assert terrain.height(*inside) == 7
    assert terrain.height(*edge) is None  # the next point belongs to the next tile
    terrain.store(block, 1, [9] * 16)
    assert terrain.height(*edge) == pytest.approx(8, abs=0.1)


def test_tiles_are_counted_once():
    terrain = TerrainMap()
    assert (terrain.pending, terrain.loaded) == (0, 0)
    assert terrain.want(*PLACE)
    (block,) = terrain.incomplete()
    assert (terrain.pending, terrain.loaded) == (56, 0)
    assert terrain.store(block, 55, [0] * 16)
    assert not terrain.store(block, 55, [1] * 16)
    assert (terrain.pending, terrain.loaded) == (55, 1)
    assert terrain.missing(block) == 2**55 - 1


def test_only_wanted_blocks_are_stored():
    terrain = TerrainMap()
    terrain.want(*PLACE)
    (block,) = terrain.incomplete()
    assert not terrain.store(block._replace(spacing=30), 0, [0] * 16)
    assert not terrain.store(block._replace(latitude=0), 0, [0] * 16)
    assert not terrain.store(block, 56, [0] * 16)
    assert terrain.loaded == 0
    assert terrain.missing(Block(0, 0, 100)) == 0


def test_another_spacing_discards_the_map():
    terrain = filled_map(PLACE)
    terrain.spacing = 100
    assert terrain.loaded == 56
    terrain.spacing = 30
    assert (terrain.loaded, terrain.pending, terrain.height(*PLACE)) == (0, 0, None)
    for spacing in (0, -1, 65_536):
        with pytest.raises(InvalidArgumentError, match="spacing"):
            TerrainMap(spacing)


def test_the_map_is_bounded():
    terrain = filled_map(PLACE)
    for number in range(MAX_BLOCKS):
        terrain.want(number * 0.05, 20.0)
    assert terrain.height(*PLACE) is None
    assert terrain.loaded == 0
    assert terrain.pending <= MAX_BLOCKS * 56
