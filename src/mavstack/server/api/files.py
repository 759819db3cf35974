"""The files and the logs on a vehicle (MAVLink FTP and the log protocol)."""

from __future__ import annotations

import asyncio
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Annotated, Any, Final

from msgspec import Meta
from starlette.responses import Response

from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import NoFields, Wait
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.json_values import to_json
from mavstack.services.ftp.payload import MAX_DATA

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.services.log import LogEntry

MAX_UPLOAD: Final = 16 << 20
_FILE: Final = "/api/vehicles/{system}/files/{path:path}"
_LOGS: Final = "/api/vehicles/{system}/logs"
_BYTES: Final = "application/octet-stream"


class Directory(Fields):
    """The query of a directory."""

    path: Annotated[str, Meta(description="The directory.", max_length=MAX_DATA)] = "/"


async def _list(call: Call[None, Directory]) -> dict[str, Any]:
    path = call.query.path
    entries: Sequence[object] = await call.vehicle.ftp.list(path)
    return {"path": path, "entries": [to_json(each) for each in entries]}


async def _download(call: Call[None, Wait]) -> Response:
    data = await call.vehicle.ftp.download(_path(call), progress=call.progress)
    return _attachment(data, _path(call).rpartition("/")[2])


async def _upload(call: Call[None, Wait]) -> dict[str, Any]:
    await call.vehicle.ftp.upload(_path(call), call.data, progress=call.progress)
    return {"path": _path(call), "size": len(call.data)}


async def _remove(call: PlainCall) -> dict[str, Any]:
    await call.vehicle.ftp.remove(_path(call))
    return {"path": _path(call)}


async def _list_logs(call: PlainCall) -> dict[str, Any]:
    vehicle = call.vehicle
    logs = await call.read("logs", vehicle.logs.list)
    return {"logs": [{"id": each.id, "time": each.time_utc, "size": each.size} for each in logs]}


async def _download_log(call: Call[None, Wait]) -> Response:
    log, data = await _read_log(call)
    return _attachment(data, f"vehicle-{call.vehicle.system}-log-{log.id}{_suffix(data)}")


async def _keep_log(call: Call[NoFields, Wait]) -> dict[str, Any]:
    system = call.vehicle.system
    log, data = await _read_log(call)
    written = f"-{datetime.fromtimestamp(log.time_utc, UTC):%Y-%m-%d-%H%M%S}" if log.time_utc else ""
    name = f"vehicle-{system}-log-{log.id}{written}{_suffix(data)}"
    return await asyncio.to_thread(call.station.recordings.keep, name, data)


async def _read_log(call: Call[Any, Wait]) -> tuple[LogEntry, bytes]:
    """Download the log that the request names; raises `RefusedError` if the vehicle has none of that id."""
    text = call.path("id")
    if not (text.isascii() and text.isdigit() and len(text) <= 5):
        raise RefusedError(404, f"ids of logs are numbers, got {text[:20]!r}")
    number = int(text)
    vehicle = call.vehicle
    listed = {each.id: each for each in await call.read("logs", vehicle.logs.list)}
    if number not in listed:
        raise RefusedError(404, f"the vehicle {vehicle.system} has no log {number}")
    log = listed[number]
    return log, await call.read(f"log {number}", lambda: vehicle.logs.download(log, progress=call.progress))


async def _erase_logs(call: PlainCall) -> dict[str, Any]:
    await call.vehicle.logs.erase()
    return {"logs": []}


def _path(call: Call[Any, Any]) -> str:
    """Return the path of a file on the vehicle: absolute, or a name that the vehicle understands (`@…`)."""
    path = call.path("path")
    return path if path.startswith(("/", "@")) else f"/{path}"


def _suffix(data: bytes) -> str:
    return ".ulg" if data.startswith(b"ULog") else ".bin"


def _attachment(data: bytes, name: str) -> Response:
    safe = "".join(each if each.isascii() and (each.isalnum() or each in "._-") else "_" for each in name)
    headers = {"Content-Disposition": f'attachment; filename="{safe or "file"}"', "Cache-Control": "no-store"}
    return Response(data, media_type=_BYTES, headers=headers)


ROUTES: Final[tuple[AnyRoute, ...]] = (
    ApiRoute(
        method="GET",
        path="/api/vehicles/{system}/files",
        handler=_list,
        summary="List a directory on a vehicle",
        tag="files",
        role=Role.ADMINISTER,
        query=Directory,
        answer={
            "path": "/",
            "entries": [{"name": "APM", "is_directory": True, "size": 0, "modified": 0}],
        },
    ),
    ApiRoute(
        method="GET",
        path=_FILE,
        handler=_download,
        summary="Download a file",
        tag="files",
        role=Role.ADMINISTER,
        query=Wait,
        media_type=_BYTES,
    ),
    ApiRoute(
        method="PUT",
        path=_FILE,
        handler=_upload,
        summary="Upload a file, or replace it",
        tag="files",
        role=Role.ADMINISTER,
        takes_bytes=True,
        max_body=MAX_UPLOAD,
        query=Wait,
        answer={"path": "/APM/scripts/a.lua", "size": 512},
    ),
    ApiRoute(
        method="DELETE",
        path=_FILE,
        handler=_remove,
        summary="Remove a file",
        tag="files",
        role=Role.ADMINISTER,
        answer={"path": "/APM/scripts/a.lua"},
    ),
    ApiRoute(
        method="GET",
        path=_LOGS,
        handler=_list_logs,
        summary="List the logs on a vehicle",
        tag="logs",
        answer={"logs": [{"id": 1, "time": 1790000000, "size": 204800}]},
    ),
    ApiRoute(
        method="GET",
        path=f"{_LOGS}/{{id}}",
        handler=_download_log,
        summary="Download a log from a vehicle",
        tag="logs",
        query=Wait,
        media_type=_BYTES,
    ),
    ApiRoute(
        method="POST",
        path=f"{_LOGS}/{{id}}",
        handler=_keep_log,
        summary="Copy a log from a vehicle to the recordings of the station, for its report page",
        tag="logs",
        role=Role.OPERATE,
        body=NoFields,
        query=Wait,
        status=201,
        answer={
            "name": "vehicle-1-log-1-2026-11-23-101500.bin",
            "size": 204800,
            "modified": 1790000000.0,
            "running": False,
            "packets": None,
        },
    ),
    ApiRoute(
        method="DELETE",
        path=_LOGS,
        handler=_erase_logs,
        summary="Erase all logs on a vehicle",
        tag="logs",
        role=Role.ADMINISTER,
        answer={"logs": []},
    ),
)
