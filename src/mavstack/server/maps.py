"""The maps of a station: archives in one folder, whose tiles it serves, and downloads into them."""

from __future__ import annotations

import asyncio
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.http.bodies import RefusedError
from mavstack.maps import MapArchive, download_area, estimate_download
from mavstack.maps.folder import list_maps, map_path, remove_map

if TYPE_CHECKING:
    from os import PathLike

    from mavstack.maps import Area, DownloadEstimate, DownloadResult, MapFacts, Pace, Tile, TileServer
    from mavstack.maps.download import Progress


class StationMaps:
    """The maps of one station.

    Args:
        folder: The folder of the archives, made when it is needed; None: there are none.
    """

    def __init__(self, folder: str | PathLike[str] | None) -> None:
        self._folder = None if folder is None else Path(folder)
        self._busy: set[str] = set()

    def list(self) -> list[MapFacts]:
        """Return the facts of the maps; blocks."""
        return [] if self._folder is None else list_maps(self._folder)

    def tile(self, name: str, tile: Tile) -> bytes | None:
        """Return a tile, or None if the map does not have it; blocks.

        Raises:
            RefusedError: There is no such map.
            MapError: The archive is damaged.
        """
        with MapArchive.open(self._existing(name)) as archive:
            return archive.get(tile)

    async def estimate(
        self, name: str, server: TileServer, area: Area, zooms: range, rate: float
    ) -> DownloadEstimate:
        """Return the size of a download; see `estimate_download`."""
        path = self._path(name)
        with MapArchive.open(path) if path.is_file() else nullcontext() as archive:
            return await estimate_download(server, area, zooms, archive, rate=rate)

    async def download(
        self,
        name: str,
        server: TileServer,
        area: Area,
        zooms: range,
        *,
        pace: Pace,
        encoding: str = "",
        attribution: str = "",
        progress: Progress | None = None,
    ) -> tuple[DownloadResult, MapFacts]:
        """Download an area into a map, a new one or one that exists.

        Raises:
            RefusedError: The station has no folder, or the map is being downloaded already.
            MapError: The download failed.
        """
        path = self._path(name)
        if name in self._busy:
            raise RefusedError(409, f"the map {name} is being downloaded already")
        self._busy.add(name)
        try:
            credit = attribution or server.terms.attribution
            with MapArchive.create(path, attribution=credit, encoding=encoding) as archive:
                result = await download_area(archive, server, area, zooms, pace=pace, progress=progress)
                return result, await asyncio.to_thread(archive.facts)
        finally:
            self._busy.discard(name)

    def remove(self, name: str) -> None:
        """Remove a map; blocks.

        Raises:
            RefusedError: There is no such map, or it is being downloaded.
            MapError: The file cannot be removed.
        """
        path = self._existing(name)
        if name in self._busy:
            raise RefusedError(409, f"the map {name} is being downloaded: cancel the download first")
        remove_map(path)

    def _path(self, name: str) -> Path:
        if self._folder is None:
            raise RefusedError(409, "the station has no folder for maps: start it with --maps FOLDER")
        return map_path(self._folder, name)

    def _existing(self, name: str) -> Path:
        path = self._path(name)
        if not path.is_file():
            raise RefusedError(404, f"there is no map {name[:60]!r}")
        return path
