"""The estimate of a download: its tiles, its bytes, and its time, before anything is stored."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.maps.failures import MapError
from mavstack.maps.tiles import Area, count_tiles, tile_at, tiles_of, wrap_longitude

if TYPE_CHECKING:
    from mavstack.maps.archive import MapArchive
    from mavstack.maps.tile_server import TileServer
    from mavstack.maps.tiles import Tile

#: Maximum number of tiles of one download; at two tiles a second this takes three days.
MAX_TILES: Final = 500_000
#: Assumed bytes of a tile if no sample tile could be downloaded.
DEFAULT_SIZE: Final = 20_000
_SAMPLES: Final = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class DownloadEstimate:
    """The size of a download.

    Attributes:
        tiles: All tiles of the area.
        missing: The tiles that the archive does not have yet.
        bytes: The bytes of the missing tiles, about.
        seconds: The time at the pace, about.
    """

    tiles: int
    missing: int
    bytes: int
    seconds: float


def check_count(area: Area, zooms: range) -> int:
    """Return the number of tiles; raises `InvalidArgumentError` if they are too many for one download."""
    count = count_tiles(area, zooms)
    if count > MAX_TILES:
        raise InvalidArgumentError(
            f"the area has {count:,} tiles, more than {MAX_TILES:,}: take a smaller area or lower zoom levels"
        )
    return count


async def estimate_download(
    server: TileServer,
    area: Area,
    zooms: range,
    archive: MapArchive | None = None,
    *,
    rate: float = 10.0,
) -> DownloadEstimate:
    """Estimate a download by a few tiles of its highest zoom level, which has most tiles.

    Args:
        server: The tile server.
        area: The area.
        zooms: The zoom levels.
        archive: The archive that is continued; None: a new one.
        rate: Requests per second.

    Returns:
        The estimate.

    Raises:
        InvalidArgumentError: The area has too many tiles, or the rate is not positive.
        MapError: The server forbids downloads, or refuses the samples.
    """
    if not rate > 0:
        raise InvalidArgumentError(f"the rate must be positive, got {rate:g} requests a second")
    if not server.terms.allowed:
        raise MapError(f"downloading tiles from {server.host} failed: {server.terms.text}")
    count = check_count(area, zooms)
    missing = count if archive is None else await asyncio.to_thread(_count_missing, archive, area, zooms)
    average = None if archive is None else archive.average_size()
    if average is None and missing:
        average = await _sampled(server, samples(area, zooms[-1]))
    return DownloadEstimate(
        tiles=count, missing=missing, bytes=round(missing * (average or DEFAULT_SIZE)), seconds=missing / rate
    )


def samples(area: Area, zoom: int) -> list[Tile]:
    """Return a few tiles along the diagonal of an area."""
    width = (area.east - area.west) % 360
    found = dict.fromkeys(
        tile_at(
            area.south + (area.north - area.south) * part,
            wrap_longitude(area.west + width * part),
            zoom,
        )
        for part in ((2 * index + 1) / (2 * _SAMPLES) for index in range(_SAMPLES))
    )
    return list(found)


def _count_missing(archive: MapArchive, area: Area, zooms: range) -> int:
    return sum(tile not in archive for tile in tiles_of(area, zooms))


async def _sampled(server: TileServer, tiles: list[Tile]) -> float | None:
    """Return the mean bytes of some tiles; None if the server has none of them."""
    sizes = []
    for tile in tiles:
        answer = await server.fetch(tile)
        if answer.retry_after is not None:
            raise MapError(f"downloading tiles from {server.host} failed: {answer.reason}")
        if answer.data:
            sizes.append(len(answer.data))
    return sum(sizes) / len(sizes) if sizes else None
