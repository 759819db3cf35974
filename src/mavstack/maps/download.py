"""The download of an area from a tile server into an archive, at a pace that the server bears.

Tiles that the archive has are left out, so a download that was interrupted continues where it ended. A server
that is busy is asked again later, after the time that it names.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.maps.estimate import check_count
from mavstack.maps.failures import MapError
from mavstack.maps.tiles import tiles_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.maps.archive import MapArchive
    from mavstack.maps.tile_server import TileServer
    from mavstack.maps.tiles import Area, Tile

    #: A callback that gets the number of finished tiles and the number of all tiles.
    Progress = Callable[[int, int], None]

#: Maximum requests per second, and maximum requests at the same time.
MAX_RATE: Final = 200.0
MAX_CONNECTIONS: Final = 8
#: Maximum number of requests for one tile, and maximum pause between two of them in seconds.
MAX_TRIES: Final = 6
MAX_PAUSE: Final = 60.0
#: Number of tiles that are written to disk together; after a loss of power, at most these are downloaded
#: again.
BATCH: Final = 50


@dataclass(frozen=True, slots=True, kw_only=True)
class Pace:
    """The pace of a download.

    Attributes:
        rate: Requests per second.
        connections: Requests at a time.

    Raises:
        InvalidArgumentError: A value is out of range.
    """

    rate: float = 10.0
    connections: int = 2

    def __post_init__(self) -> None:
        if not 0 < self.rate <= MAX_RATE:
            raise InvalidArgumentError(f"the rate must be above 0 and at most {MAX_RATE:g} requests a second")
        if not 1 <= self.connections <= MAX_CONNECTIONS:
            raise InvalidArgumentError(f"connections are from 1 to {MAX_CONNECTIONS}, got {self.connections}")


@dataclass(slots=True, kw_only=True)
class DownloadResult:
    """The result of a download.

    Attributes:
        tiles: All tiles of the area.
        present: The tiles that the archive had before.
        added: The tiles that were downloaded.
        absent: The tiles that the server does not have.
        bytes: The bytes of the downloaded tiles.
    """

    tiles: int
    present: int = 0
    added: int = 0
    absent: int = 0
    bytes: int = 0

    @property
    def done(self) -> int:
        """The number of tiles that are finished."""
        return self.present + self.added + self.absent


async def download_area(
    archive: MapArchive,
    server: TileServer,
    area: Area,
    zooms: range,
    *,
    pace: Pace | None = None,
    progress: Progress | None = None,
) -> DownloadResult:
    """Download the tiles of an area that an archive lacks.

    Args:
        archive: The archive, open for writing.
        server: The tile server.
        area: The area.
        zooms: The zoom levels.
        pace: The pace; None: ten requests a second, two at a time.
        progress: Called with the tiles that are finished, and all tiles.

    Returns:
        The result. If the call is cancelled, the archive has the tiles until then.

    Raises:
        InvalidArgumentError: The area has too many tiles.
        MapError: The server forbids downloads, refuses requests or does not answer, or the disk is full.
    """
    if not server.terms.allowed:
        raise MapError(f"downloading tiles from {server.host} failed: {server.terms.text}")
    result = DownloadResult(tiles=check_count(area, zooms))
    download = _Download(archive, server, (area, zooms), pace or Pace(), (result, progress))
    await download.run()
    if result.added == 0 and result.present == 0:
        raise MapError(
            f"downloading tiles from {server.host} failed: it has no tile of the area at these zoom levels"
        )
    return result


class _Download:
    """The state of one download, which all its workers share."""

    def __init__(
        self,
        archive: MapArchive,
        server: TileServer,
        cover: tuple[Area, range],
        pace: Pace,
        report: tuple[DownloadResult, Progress | None],
    ) -> None:
        self._archive = archive
        self._server = server
        self._area, self._zooms = cover
        self._pace = pace
        self._result, self._progress = report
        self._next = 0.0
        self._unwritten = 0
        # A slow disk holds up a thread, not the event loop; meanwhile the workers leave the archive alone.
        self._disk = asyncio.Lock()

    async def run(self) -> None:
        """Download all missing tiles."""
        tiles = tiles_of(self._area, self._zooms)
        try:
            async with asyncio.TaskGroup() as workers:
                for _ in range(self._pace.connections):
                    workers.create_task(self._work(tiles))
            await self._commit()
        except ExceptionGroup as errors:
            raise errors.exceptions[0] from None
        finally:
            self._archive.commit()

    async def _commit(self) -> None:
        self._unwritten = 0
        async with self._disk:
            await asyncio.to_thread(self._archive.commit)

    async def _work(self, tiles: Iterator[Tile]) -> None:
        """Take tiles from those that all workers share, and download those that the archive lacks."""
        for tile in tiles:
            async with self._disk:
                is_present = tile in self._archive
            if not is_present:
                await self._store(tile)
                continue
            self._result.present += 1
            if self._result.present % BATCH == 0:
                self._report()
                await asyncio.sleep(0)

    async def _store(self, tile: Tile) -> None:
        """Download one tile, and store it."""
        for attempt in range(MAX_TRIES):
            await self._turn()
            answer = await self._server.fetch(tile)
            if answer.retry_after is None:
                await self._keep(tile, answer.data, answer.format)
                return
            pause = min(MAX_PAUSE, max(answer.retry_after, 0.5 * 2**attempt))
            self._next = max(self._next, asyncio.get_running_loop().time() + pause)
            reason = answer.reason
        raise MapError(
            f"downloading tiles from {self._server.host} failed: {reason}; run it again later to continue"
        )

    async def _turn(self) -> None:
        """Wait until the pace permits a request."""
        loop = asyncio.get_running_loop()
        start = max(self._next, loop.time())
        self._next = start + 1 / self._pace.rate
        await asyncio.sleep(start - loop.time())

    async def _keep(self, tile: Tile, data: bytes, form: str) -> None:
        result = self._result
        if data:
            async with self._disk:
                if result.added == 0:
                    self._archive.extend(self._area, self._zooms, form)
                self._archive.put(tile, data)
            result.added += 1
            result.bytes += len(data)
        else:
            result.absent += 1
        self._unwritten += 1
        if self._unwritten >= BATCH:
            await self._commit()
        self._report()

    def _report(self) -> None:
        if self._progress is not None:
            self._progress(self._result.done, self._result.tiles)
