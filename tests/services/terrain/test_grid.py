from __future__ import annotations

from math import cos, hypot, radians

import pytest

from mavstack.services.terrain.grid import ALL_TILES, Block, locate, moved

METRES = 111_319.0
PLACES = [(47.39774, 8.54559), (-35.363, 149.165), (64.9999, -21.9999), (-0.001, -0.001), (0.0, 179.9999)]


def offset(one: tuple[float, float], other: tuple[float, float]) -> tuple[float, float]:
    """Return the metres north and east from one position to another."""
    east = (other[1] - one[1] + 180) % 360 - 180
    return (other[0] - one[0]) * METRES, east * METRES * cos(radians((one[0] + other[0]) / 2))


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("spacing", [30, 100])
def test_a_position_lies_between_four_points_of_its_block(place, spacing):
    found = locate(*place, spacing)  # type: ignore[call-arg]
    assert 0 <= found.north < 24
    assert 0 <= found.east < 28
    north, east = offset(found.block.position_of(found.north, found.east), place)
    # the mean latitudes of the block and of the position differ
    assert north == pytest.approx(found.north_share * spacing, abs=1)
    assert east == pytest.approx(found.east_share * spacing, abs=30)


def test_the_corner_of_a_degree_begins_a_block():
    found = locate(47.0, 8.0, 100)
    assert found == (Block(470_000_000, 80_000_000, 100), 0, 0, 0.0, 0.0)
    south_west = locate(-0.5, -0.5, 100).block
    assert locate(-1.0, -1.0, 100).block == Block(-10_000_000, -10_000_000, 100)
    assert south_west.latitude < -5_000_000
    assert south_west.longitude < -5_000_000


def test_neighbouring_blocks_share_a_tile():
    first = locate(47.0, 8.0, 100).block
    east = locate(*moved(*first.position_of(0, 28), 10, 10), 100).block
    north = locate(*moved(*first.position_of(24, 0), 10, 10), 100).block
    assert offset(first.position_of(0, 28), east.position_of(0, 0)) == pytest.approx((0, 0), abs=1)
    assert offset(first.position_of(24, 0), north.position_of(0, 0)) == pytest.approx((0, 0), abs=1)


def test_tiles_and_points_are_numbered_eastward_first():
    block = Block(470_000_000, 80_000_000, 100)
    corner = block.position_of(0, 0)
    assert ALL_TILES == 2**56 - 1
    tile = [offset(corner, position) for position in block.tile_positions(0)]
    assert tile[0] == (0, 0)
    assert tile[1] == pytest.approx((0, 100), abs=0.5)
    assert tile[4] == pytest.approx((100, 0), abs=0.5)
    last = [offset(corner, position) for position in block.tile_positions(55)]
    assert last[0] == pytest.approx((2400, 2800), abs=5)
    assert last[15] == pytest.approx((2700, 3100), abs=5)


def test_metres_become_degrees():
    assert offset(PLACES[0], moved(*PLACES[0], 3000, -2000)) == pytest.approx((3000, -2000), abs=3)
    assert moved(0.0, 179.9999, 0, 1000)[1] == pytest.approx(-179.991, abs=1e-3)
    assert moved(89.9999, 0.0, 1000, 0)[0] == 90
    assert hypot(*moved(90.0, 0.0, 0, 0)) == 90


@pytest.mark.parametrize("block", [(0, 0, 0), (900_000_001, 0, 100), (0, -1_800_000_001, 100)])
def test_impossible_blocks(block):
    assert not Block(*block).is_valid
    assert Block(900_000_000, 1_800_000_000, 1).is_valid
