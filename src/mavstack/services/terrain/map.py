"""The terrain that a vehicle holds: blocks of heights, filled tile by tile."""

from __future__ import annotations

from array import array
from collections import OrderedDict
from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.services.terrain.grid import (
    ALL_TILES,
    DEFAULT_SPACING,
    POINTS_EAST,
    POINTS_NORTH,
    TILE_EDGE,
    TILES,
    TILES_EAST,
    Block,
    GridPlace,
    locate,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

#: The largest number of blocks in a map; the least recently used block is dropped. TERRAIN_REPORT can count
#: their tiles.
MAX_BLOCKS: Final = 1024
MAX_SPACING: Final = 65_535


class BlockHeights:
    """The heights of one block, as far as they are known."""

    __slots__ = ("_heights", "mask")

    def __init__(self) -> None:
        self._heights = array("h", bytes(2 * POINTS_NORTH * POINTS_EAST))
        #: The known tiles as a bit mask.
        self.mask = 0

    @property
    def missing(self) -> int:
        """The tiles that are not known, as bits: the mask of a TERRAIN_REQUEST."""
        return ALL_TILES & ~self.mask

    def store(self, tile: int, heights: Sequence[int]) -> bool:
        """Store a tile; returns whether it was missing."""
        north, east = (each * TILE_EDGE for each in divmod(tile, TILES_EAST))
        for row in range(TILE_EDGE):
            start = (north + row) * POINTS_EAST + east
            self._heights[start : start + TILE_EDGE] = array("h", heights[row * TILE_EDGE :][:TILE_EDGE])
        added = not self.mask >> tile & 1
        self.mask |= 1 << tile
        return added

    def height(self, north: int, east: int) -> int | None:
        """Return the height of a point in metres; None if its tile is not known."""
        tile = east // TILE_EDGE + north // TILE_EDGE * TILES_EAST
        return self._heights[north * POINTS_EAST + east] if self.mask >> tile & 1 else None


class TerrainMap:
    """The heights of the terrain, of one spacing.

    Args:
        spacing: Metres between two points, 1 to 65535.

    Raises:
        InvalidArgumentError: The spacing is out of range.
    """

    def __init__(self, spacing: int = DEFAULT_SPACING) -> None:
        self._blocks: OrderedDict[Block, BlockHeights] = OrderedDict()
        self._spacing = 0
        self._loaded = 0
        self.spacing = spacing

    @property
    def spacing(self) -> int:
        """Metres between two points; a new value discards all heights."""
        return self._spacing

    @spacing.setter
    def spacing(self, spacing: int) -> None:
        if not 1 <= spacing <= MAX_SPACING:
            raise InvalidArgumentError(f"the spacing of terrain must be 1 to {MAX_SPACING} m, got {spacing}")
        if spacing != self._spacing:
            self._spacing = spacing
            self.clear()

    def clear(self) -> None:
        """Discard all heights."""
        self._blocks.clear()
        self._loaded = 0

    @property
    def loaded(self) -> int:
        """The number of tiles that are known."""
        return self._loaded

    @property
    def pending(self) -> int:
        """The number of tiles that are missing in the blocks that the map holds."""
        return len(self._blocks) * TILES - self._loaded

    def want(self, latitude: float, longitude: float) -> bool:
        """Add the block of a position, in degrees; returns whether some of its tiles are missing."""
        block = locate(latitude, longitude, self._spacing).block
        heights = self._blocks.get(block)
        if heights is None:
            heights = self._blocks[block] = BlockHeights()
            if len(self._blocks) > MAX_BLOCKS:
                _, oldest = self._blocks.popitem(last=False)
                self._loaded -= oldest.mask.bit_count()
        self._blocks.move_to_end(block)
        return bool(heights.missing)

    def missing(self, block: Block) -> int:
        """Return the missing tiles of a block as bits; 0 if the map does not hold the block."""
        heights = self._blocks.get(block)
        return heights.missing if heights is not None else 0

    def incomplete(self) -> Iterator[Block]:
        """Yield the blocks that lack tiles, the least recently wanted first."""
        return (block for block, heights in self._blocks.items() if heights.missing)

    def store(self, block: Block, tile: int, heights: Sequence[int]) -> bool:
        """Store a tile.

        Args:
            block: The block; it is ignored unless the map holds it.
            tile: The number of the tile.
            heights: The heights of its 16 points in metres.

        Returns:
            True if the tile was missing.
        """
        known = self._blocks.get(block)
        if known is None or not 0 <= tile < TILES:
            return False
        added = known.store(tile, heights)
        self._loaded += added
        return added

    def height(self, latitude: float, longitude: float) -> float | None:
        """Return the height of the terrain between the four points around a position.

        Args:
            latitude: Degrees.
            longitude: Degrees.

        Returns:
            Metres above mean sea level; None if one of the points is not known.
        """
        if not (isfinite(latitude) and isfinite(longitude)):
            return None
        place = locate(latitude, longitude, self._spacing)
        known = self._blocks.get(place.block)
        if known is None:
            return None
        return _between(known, place)


def _between(known: BlockHeights, place: GridPlace) -> float | None:
    """Return the height at a place, linear between the four points around it."""
    north, east = place.north, place.east
    south_west, south_east = known.height(north, east), known.height(north, east + 1)
    north_west, north_east = known.height(north + 1, east), known.height(north + 1, east + 1)
    if south_west is None or south_east is None or north_west is None or north_east is None:
        return None
    southern = south_west + (south_east - south_west) * place.east_share
    northern = north_west + (north_east - north_west) * place.east_share
    return southern + (northern - southern) * place.north_share
