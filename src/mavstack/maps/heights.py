"""Heights of the terrain from an archive whose pictures are heights; needs the extra `maps`."""

from __future__ import annotations

import logging
from collections import OrderedDict
from io import BytesIO
from math import isfinite
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import MissingExtraError
from mavstack.maps.archive import MapArchive
from mavstack.maps.failures import MapError
from mavstack.maps.tiles import MAX_LATITUDE, Tile, place_at, wrap_longitude

try:
    from PIL import Image
except ImportError as error:
    raise MissingExtraError("heights of terrain tiles", "maps") from error

if TYPE_CHECKING:
    import os
    from typing import Self

    from numpy.typing import NDArray

logger = logging.getLogger("mavstack.maps")

#: Maximum number of tiles in memory; a tile of 256 by 256 points takes half a megabyte.
MAX_LOADED: Final = 32
#: Maximum number of points along the edge of a tile.
MAX_EDGE: Final = 1024
#: A height below this, in metres, means "no data"; black and transparent pixels decode to such heights.
_NO_HEIGHT: Final = -9000.0
#: Formats that Pillow may decode; it runs other programs for some of the others.
_FORMATS: Final = ("PNG", "WEBP", "JPEG")


class TileHeights:
    """The heights of an archive; an instance is called with a latitude and a longitude. A context manager.

    Args:
        path: The archive (MBTiles) with the row `encoding`.

    Raises:
        MapError: The file is not such an archive.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._archive = MapArchive.open(path)
        facts = self._archive.facts()
        if not facts.encoding:
            self._archive.close()
            raise MapError(
                f"reading {path} failed: its pictures are not heights (mav map download --terrain)"
            )
        #: The metadata of the archive.
        self.facts = facts
        self._loaded: OrderedDict[Tile, NDArray[np.float64] | None] = OrderedDict()

    def __call__(self, latitude: float, longitude: float) -> float | None:
        """Return the height of a position, linear between the points around it.

        Args:
            latitude: Degrees.
            longitude: Degrees.

        Returns:
            Metres above mean sea level; None if the archive does not have it.
        """
        if not (isfinite(latitude) and isfinite(longitude) and abs(latitude) < MAX_LATITUDE):
            return None
        zoom = self.facts.max_zoom
        x, y = place_at(latitude, wrap_longitude(longitude), zoom)
        tile = Tile(zoom, int(x), int(y))
        heights = self._heights(tile)
        if heights is None:
            return None
        return _between(heights, y - int(y), x - int(x))

    def close(self) -> None:
        """Close the archive. Idempotent."""
        self._archive.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _heights(self, tile: Tile) -> NDArray[np.float64] | None:
        if tile in self._loaded:
            self._loaded.move_to_end(tile)
            return self._loaded[tile]
        data = self._archive.get(tile)
        found = None if data is None else _decode(data, self.facts.encoding)
        self._loaded[tile] = found
        if len(self._loaded) > MAX_LOADED:
            self._loaded.popitem(last=False)
        return found


def _decode(data: bytes, encoding: str) -> NDArray[np.float64] | None:
    """Return the heights of a picture, rows from north to south; None if it is damaged."""
    try:
        with Image.open(BytesIO(data), formats=_FORMATS) as picture:
            if max(picture.size) > MAX_EDGE or min(picture.size) < 2:
                raise ValueError(f"a tile of {picture.size} points")
            colours = np.asarray(picture.convert("RGB"), np.float64)
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        logger.warning("a tile of heights is damaged: %s", error)
        return None
    red, green, blue = colours[..., 0], colours[..., 1], colours[..., 2]
    if encoding == "terrarium":
        return red * 256 + green + blue / 256 - 32_768
    return (red * 65_536 + green * 256 + blue) / 10 - 10_000


def _between(heights: NDArray[np.float64], south: float, east: float) -> float | None:
    """Return the height at parts of a tile: pixels have their height in their middle."""
    rows, columns = heights.shape
    row = min(max(south * rows - 0.5, 0.0), rows - 1.0)
    column = min(max(east * columns - 0.5, 0.0), columns - 1.0)
    top, left = min(int(row), rows - 2), min(int(column), columns - 2)
    square = heights[top : top + 2, left : left + 2]
    if square.min() <= _NO_HEIGHT:
        return None
    low, right = row - top, column - left
    weights = np.outer((1 - low, low), (1 - right, right))
    return float((square * weights).sum())
