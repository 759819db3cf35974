"""Heights of the terrain from .hgt files, as published for the Shuttle Radar Topography Mission (SRTM).

A file covers one degree by one degree and is named by its south-western corner: N47E008.hgt, or zipped,
N47E008.hgt.zip. It holds rows of big-endian 16-bit heights in metres, from north to south, each from west to
east: 1201 by 1201 points (three seconds of arc) or 3601 by 3601 (one second). Neighbouring files share their
edges. -32768 stands for an unknown height. Source: the SRTM documentation of NASA.
"""

from __future__ import annotations

import logging
import re
import sys
import zipfile
import zlib
from array import array
from collections import OrderedDict
from math import floor, isfinite
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.bounded_file import read_file_bounded
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

logger = logging.getLogger("mavstack.files")

_NAME = re.compile(r"([NS])(\d{2})([EW])(\d{3})\.hgt(\.zip)?", re.IGNORECASE)
#: Number of points along an edge of a tile, by the size of its file in bytes.
_EDGES: Final[Mapping[int, int]] = MappingProxyType({2 * edge * edge: edge for edge in (1201, 3601)})
_MAX_SIZE: Final = max(_EDGES)
_UNKNOWN: Final = -32_768
#: Maximum number of files in memory; a file with a resolution of one second of arc takes 26 MB.
MAX_LOADED: Final = 4


class HgtFolder:
    """The heights in the .hgt files of a folder; an instance is called with a latitude and a longitude.

    Args:
        folder: The folder with files such as N47E008.hgt or N47E008.hgt.zip.

    Raises:
        OSError: The folder cannot be read.
        InvalidArgumentError: It has no such file.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        files = sorted(self.folder.iterdir())
        self._paths = {corner: path for path in files if (corner := _corner(path.name)) is not None}
        if not self._paths:
            raise InvalidArgumentError(f"{self.folder} has no .hgt files, such as N47E008.hgt")
        self._loaded: OrderedDict[tuple[int, int], array[int] | None] = OrderedDict()

    def __len__(self) -> int:
        return len(self._paths)

    def __call__(self, latitude: float, longitude: float) -> float | None:
        """Return the height of a position, linear between the four points around it.

        Args:
            latitude: Degrees.
            longitude: Degrees.

        Returns:
            Metres above mean sea level; None if no file has it.
        """
        if not (isfinite(latitude) and isfinite(longitude)):
            return None
        corner = floor(latitude), floor(longitude)
        heights = self._heights(corner)
        if heights is None:
            return None
        edge = _EDGES[2 * len(heights)]
        south, east = (corner[0] + 1 - latitude) * (edge - 1), (longitude - corner[1]) * (edge - 1)
        row, column = min(int(south), edge - 2), min(int(east), edge - 2)
        first = row * edge + column
        points = heights[first], heights[first + 1], heights[first + edge], heights[first + edge + 1]
        if _UNKNOWN in points:
            return None
        north_west, north_east, south_west, south_east = points
        northern = north_west + (north_east - north_west) * (east - column)
        southern = south_west + (south_east - south_west) * (east - column)
        return northern + (southern - northern) * (south - row)

    def _heights(self, corner: tuple[int, int]) -> array[int] | None:
        """Return the heights of a file; None if there is none, or it is damaged."""
        if corner in self._loaded:
            self._loaded.move_to_end(corner)
            return self._loaded[corner]
        path = self._paths.get(corner)
        heights = None if path is None else _read(path)
        if path is not None:
            self._loaded[corner] = heights
            if len(self._loaded) > MAX_LOADED:
                self._loaded.popitem(last=False)
        return heights


def _corner(name: str) -> tuple[int, int] | None:
    """Return the corner that the name of a file tells; None for another name."""
    match = _NAME.fullmatch(name)
    if match is None:
        return None
    latitude = int(match[2]) * (1 if match[1] in "Nn" else -1)
    return latitude, int(match[4]) * (1 if match[3] in "Ee" else -1)


def _read(path: Path) -> array[int] | None:
    try:
        data = _unzipped(path) if path.suffix.lower() == ".zip" else read_file_bounded(path, _MAX_SIZE + 1)
    except (OSError, ValueError, zipfile.BadZipFile, zlib.error, EOFError, RuntimeError) as error:
        logger.warning("cannot open %s: %s", path, error)
        return None
    if len(data) not in _EDGES:
        logger.warning("cannot open %s: neither 1201 x 1201 nor 3601 x 3601 heights", path)
        return None
    heights = array("h", data)
    if sys.byteorder == "little":
        heights.byteswap()
    return heights


def _unzipped(path: Path) -> bytes:
    """Return the only file of an archive, read no further than the largest size."""
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        if len(names) != 1:
            raise ValueError(f"an archive of one file was expected, it has {len(names)}")
        with archive.open(names[0]) as file:
            return file.read(_MAX_SIZE + 1)
