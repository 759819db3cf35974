"""Maps for places without network: tiles of a server in one file, and heights of the terrain from a file.

    from mavstack.maps import Area, MapArchive, TileServer, download_area

    area = Area(south=47.39, west=8.53, north=47.41, east=8.56)
    with MapArchive.create("field.mbtiles") as archive:
        server = TileServer("https://tiles.example.org/{z}/{x}/{y}.png")
        await download_area(archive, server, area, range(10, 17))

The file is an MBTiles archive, which other programs read too.
"""

from mavstack.maps.archive import MapArchive, MapFacts
from mavstack.maps.download import DownloadResult, Pace, download_area
from mavstack.maps.estimate import DownloadEstimate, estimate_download
from mavstack.maps.failures import MapError
from mavstack.maps.terms import ServerTerms, terms_of
from mavstack.maps.tile_server import TileServer
from mavstack.maps.tiles import Area, Tile, count_tiles

__all__ = [
    "Area",
    "DownloadEstimate",
    "DownloadResult",
    "MapArchive",
    "MapError",
    "MapFacts",
    "Pace",
    "ServerTerms",
    "Tile",
    "TileServer",
    "count_tiles",
    "download_area",
    "estimate_download",
    "terms_of",
]
