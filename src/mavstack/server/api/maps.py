"""Maps for places without network: the archives of the station, their tiles, and downloads into them."""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from typing import Annotated, Any, Final, Literal, TypeAlias

from msgspec import Meta, Struct
from starlette.responses import Response

from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable, Wait
from mavstack.maps import Area, Pace, Tile, TileServer
from mavstack.maps.download import MAX_CONNECTIONS, MAX_RATE
from mavstack.maps.tiles import MAX_ZOOM, check_zooms
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.request_types import Latitude, Longitude, Text

#: How long a browser caches a tile, in seconds (`max-age`).
KEEPING: Final = "private, max-age=3600"
_MEDIA_TYPES: Final = (
    (b"\x89PNG", "image/png"),
    (b"\xff\xd8\xff", "image/jpeg"),
    (b"RIFF", "image/webp"),
)
_GZIP: Final = b"\x1f\x8b"
_VECTORS: Final = "application/vnd.mapbox-vector-tile"
_Zoom: TypeAlias = Annotated[int, Meta(ge=0, le=MAX_ZOOM)]


class _AreaFields(Fields):
    """The fields of an area of a tile server."""

    server: Annotated[
        Text,
        Meta(
            description="The address of the tiles, with {z}, {x} and {y}.",
            examples=["http://127.0.0.1:9/{z}/{x}/{y}.png"],
        ),
    ]
    south: Annotated[Latitude, Meta(description="Degrees.", examples=[47.39])]
    west: Annotated[
        Longitude, Meta(description="Degrees; above `east` across the antimeridian.", examples=[8.53])
    ]
    north: Annotated[Latitude, Meta(description="Degrees.", examples=[47.41])]
    east: Annotated[Longitude, Meta(description="Degrees.", examples=[8.56])]
    min_zoom: Annotated[_Zoom, Meta(description="The lowest zoom level.")] = 10
    max_zoom: Annotated[_Zoom, Meta(description="The highest zoom level.")] = 16
    rate: Annotated[float, Meta(description="Requests per second.", gt=0, le=MAX_RATE)] = 10.0

    def area(self) -> Area:
        """Return the area."""
        return Area(south=self.south, west=self.west, north=self.north, east=self.east)

    def zooms(self) -> range:
        """Return the zoom levels."""
        return check_zooms(self.min_zoom, self.max_zoom)


class EstimateMap(_AreaFields, kw_only=True):
    """Estimate the download of a map by a few tiles."""


class DownloadMap(_AreaFields, kw_only=True):
    """Download the tiles of an area into a map of the station."""

    connections: Annotated[int, Meta(description="Requests at a time.", ge=1, le=MAX_CONNECTIONS)] = 2
    encoding: Annotated[
        Literal["", "terrarium", "mapbox"], Meta(description="The encoding, if the pictures are heights.")
    ] = ""
    attribution: Annotated[Text, Meta(description="The credit of the owner of the tiles.")] = ""


class MapInfo(Struct):
    """The facts of a map; `area` has south, west, north and east in degrees, or is null."""

    name: str
    format: str
    encoding: str
    attribution: str
    area: dict[str, float] | None
    min_zoom: int
    max_zoom: int
    layers: list[str]
    tiles: int
    size: int


class MapEstimate(Struct):
    """The size of a download, with the tiles that the map lacks, and the terms of the server."""

    tiles: int
    missing: int
    bytes: int
    seconds: float
    host: str
    terms: str


class MapDownloaded(Struct):
    """The result of a download: all tiles, those that were there, were added, and are not on the server."""

    tiles: int
    present: int
    added: int
    absent: int
    bytes: int
    map: MapInfo


_MAP: Final = {
    "name": "field",
    "format": "png",
    "encoding": "",
    "attribution": "© the owner of the tiles",
    "area": {"south": 47.39, "west": 8.53, "north": 47.41, "east": 8.56},
    "min_zoom": 10,
    "max_zoom": 16,
    "layers": [],
    "tiles": 120,
    "size": 2400000,
}
_PARTS: Final = {"name": "field", "zoom": 10, "x": 536, "y": 358}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "maps")


@ROUTES.add("GET", "/api/maps", "List the maps of the station", answer=[_MAP], answer_model=list[MapInfo])
async def _list(call: PlainCall) -> list[dict[str, Any]]:
    return [asdict(facts) for facts in await asyncio.to_thread(call.station.maps.list)]


@ROUTES.add(
    "GET",
    "/api/maps/{name}/{zoom}/{x}/{y}",
    "Get a tile of a map; 204 where the map has none",
    path_examples=_PARTS,
    media_type="image/*",
)
async def _tile(call: PlainCall) -> Response:
    place = [_number(call.path(part)) for part in ("zoom", "x", "y")]
    tile = Tile(*place)
    if tile.zoom > MAX_ZOOM or max(tile.x, tile.y) >> tile.zoom:
        raise RefusedError(404, f"zoom level {tile.zoom} has no tile {tile.x}, {tile.y}")
    data = await asyncio.to_thread(call.station.maps.tile, call.path("name"), tile)
    headers = {"Cache-Control": KEEPING}
    if data is None:  # a place outside of the map is not an error
        return Response(status_code=204, headers=headers)
    if data.startswith(_GZIP):
        headers["Content-Encoding"] = "gzip"
    kinds = (kind for magic, kind in _MEDIA_TYPES if data.startswith(magic))
    return Response(data, media_type=next(kinds, _VECTORS), headers=headers)


@ROUTES.add(
    "POST",
    "/api/maps/{name}/estimate",
    path_examples={"name": "field"},
    role=Role.ADMINISTER,
    answer={
        "tiles": 120,
        "missing": 120,
        "bytes": 2400000,
        "seconds": 12.0,
        "host": "tiles.example.org",
        "terms": "the owner of the server decides whether areas may be downloaded, and how fast: …",
    },
    answer_model=MapEstimate,
)
async def _estimate(call: Call[EstimateMap, None]) -> dict[str, Any]:
    body = call.body
    server = TileServer(body.server)
    estimate = await call.station.maps.estimate(
        call.path("name"), server, body.area(), body.zooms(), body.rate
    )
    return {**asdict(estimate), "host": server.host, "terms": server.terms.text}


@ROUTES.add(
    "POST",
    "/api/maps/{name}",
    path_examples={"name": "field"},
    role=Role.ADMINISTER,
    answer={"tiles": 120, "present": 0, "added": 118, "absent": 2, "bytes": 2400000, "map": _MAP},
    answer_model=MapDownloaded,
)
async def _download(call: Call[DownloadMap, Wait]) -> dict[str, Any]:
    body = call.body
    result, facts = await call.station.maps.download(
        call.path("name"),
        TileServer(body.server),
        body.area(),
        body.zooms(),
        pace=Pace(rate=body.rate, connections=body.connections),
        encoding=body.encoding,
        attribution=body.attribution,
        progress=call.progress,
    )
    return {**asdict(result), "map": asdict(facts)}


@ROUTES.add(
    "DELETE",
    "/api/maps/{name}",
    "Remove a map",
    path_examples={"name": "field"},
    role=Role.ADMINISTER,
    answer={"removed": "field"},
)
async def _remove(call: PlainCall) -> dict[str, Any]:
    await asyncio.to_thread(call.station.maps.remove, call.path("name"))
    return {"removed": call.path("name")}


def _number(text: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        raise RefusedError(404, f"the numbers of a tile must be integers, got {text[:20]!r}")
    return int(text)
