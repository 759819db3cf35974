"""The recordings of the station, and report pages about them."""

from __future__ import annotations

import asyncio
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated, Any, Final, TypeAlias

from msgspec import Meta
from starlette.responses import FileResponse, HTMLResponse, Response, StreamingResponse

from mavstack.http.request_fields import Fields
from mavstack.http.routes import NoFields, RouteTable, Wait
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.recordings import NAME_PATTERN
from mavstack.server.request_types import MAX_TEXT

if TYPE_CHECKING:
    from collections.abc import Iterator

#: Number of bytes that are read at a time.
CHUNK_SIZE: Final = 1 << 18
#: The largest log that a client may send for a replay, in bytes.
MAX_REPLAY: Final = 1 << 28
_BYTES: Final = "application/octet-stream"

#: The content security policy of a report: the page loads nothing, and has no access to the station.
REPORT_POLICY: Final = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; "
    "sandbox allow-scripts"
)


FileName: TypeAlias = Annotated[str, Meta(pattern=f"^{NAME_PATTERN}$(?!\\n)", max_length=MAX_TEXT)]


class StartRecording(Fields):
    """Begin a recording."""

    name: Annotated[
        FileName | None,
        Meta(description="The name of the file; null: one with the time of day.", examples=["flight.tlog"]),
    ] = None


class ReplayQuery(Wait):
    """The query of the flight of a log that is sent."""

    name: Annotated[
        FileName, Meta(description="The name of the file, for errors.", examples=["flight.BIN"])
    ] = "log"


_EXAMPLE: Final = {
    "name": "2026-11-23-101500.tlog",
    "size": 51200,
    "modified": 1790000000.0,
    "running": True,
    "packets": 800,
}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "recordings")


@ROUTES.add("GET", "/api/recordings", "List the recordings and logs of the station", answer=[_EXAMPLE])
async def _list(call: PlainCall) -> list[dict[str, Any]]:
    return await asyncio.to_thread(call.station.recordings.list)


@ROUTES.add("POST", "/api/recordings", role=Role.OPERATE, status=201, answer=_EXAMPLE)
async def _start(call: Call[StartRecording, None]) -> dict[str, Any]:
    return call.station.recordings.start(call.body.name)


@ROUTES.add(
    "POST",
    "/api/recordings/{name}/stop",
    "End a recording",
    path_examples={"name": "flight.tlog"},
    role=Role.OPERATE,
    answer=_EXAMPLE | {"running": False, "packets": None},
)
async def _stop(call: Call[NoFields, None]) -> dict[str, Any]:
    return call.station.recordings.stop(call.path("name"))


@ROUTES.add(
    "GET",
    "/api/recordings/{name}",
    "Download a recording",
    path_examples={"name": "flight.tlog"},
    media_type=_BYTES,
)
async def _download(call: PlainCall) -> Response:
    recordings, name = call.station.recordings, call.path("name")
    path = recordings.path(name)
    if recordings.is_running(name):
        return file_so_far(path, _BYTES)
    return FileResponse(path, filename=path.name, media_type=_BYTES)


def file_so_far(path: Path, media_type: str) -> Response:
    """Return the present bytes of a file that grows: an answer must not be longer than its header says."""
    size = path.stat().st_size
    headers = {"Content-Length": str(size), "Content-Disposition": f'attachment; filename="{path.name}"'}
    return StreamingResponse(_chunks(path, size), media_type=media_type, headers=headers)


def _chunks(path: Path, size: int) -> Iterator[bytes]:
    with path.open("rb") as file:
        while size > 0 and (data := file.read(min(size, CHUNK_SIZE))):
            size -= len(data)
            yield data


@ROUTES.add(
    "GET", "/api/reports/{log}", "Show the report page of a recording or a log", media_type="text/html"
)
async def _report(call: Call[None, Wait]) -> Response:
    path = call.station.recordings.path(call.path("log"))
    page = await asyncio.to_thread(_report_page, path)
    return HTMLResponse(page, headers={"Content-Security-Policy": REPORT_POLICY})


def _report_page(path: Path) -> str:
    from mavstack.logs import open_log
    from mavstack.logs.report import make_report

    return make_report(open_log(path)).html


@ROUTES.add(
    "GET",
    "/api/replays/{log}",
    "Show the flight of a recording or a log as a tlog, whatever its format",
    path_examples={"log": "flight.BIN"},
    media_type=_BYTES,
)
async def _replay(call: Call[None, Wait]) -> Response:
    path = call.station.recordings.path(call.path("log"))
    return _replay_file(await asyncio.to_thread(_replay_of, path), path.name)


@ROUTES.add(
    "POST",
    "/api/replays",
    "Show the flight of a log that is sent as a tlog, whatever its format",
    role=Role.OPERATE,
    takes_bytes=True,
    max_body=MAX_REPLAY,
    media_type=_BYTES,
)
async def _replay_upload(call: Call[None, ReplayQuery]) -> Response:
    name = call.query.name
    return _replay_file(await asyncio.to_thread(_replay_of_bytes, call.data, name), name)


def _replay_of(path: Path) -> bytes:
    from mavstack.logs import open_log
    from mavstack.logs.replay import replay_tlog

    return replay_tlog(open_log(path))


def _replay_of_bytes(data: bytes, name: str) -> bytes:
    with TemporaryDirectory(prefix="mavstack-replay-") as folder:
        path = Path(folder) / name
        path.write_bytes(data)
        return _replay_of(path)


def _replay_file(data: bytes, name: str) -> Response:
    headers = {"Content-Disposition": f'attachment; filename="{Path(name).stem}.tlog"'}
    return Response(data, media_type=_BYTES, headers=headers)
