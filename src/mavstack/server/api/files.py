"""The files and the logs on a vehicle (MAVLink FTP and the log protocol)."""

from __future__ import annotations

import asyncio
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Annotated, Any, Final

from msgspec import Meta
from starlette.responses import Response

from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import NoFields, RouteTable, Wait
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


ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "files")


@ROUTES.add(
    "GET",
    "/api/vehicles/{system}/files",
    "List a directory on a vehicle",
    role=Role.ADMINISTER,
    answer={
        "path": "/",
        "entries": [{"name": "APM", "is_directory": True, "size": 0, "modified": 0}],
    },
)
async def _list(call: Call[None, Directory]) -> dict[str, Any]:
    path = call.query.path
    entries: Sequence[object] = await call.vehicle.ftp.list(path)
    return {"path": path, "entries": [to_json(each) for each in entries]}


@ROUTES.add("GET", _FILE, "Download a file", role=Role.ADMINISTER, media_type=_BYTES)
async def _download(call: Call[None, Wait]) -> Response:
    data = await call.vehicle.ftp.download(_path(call), progress=call.progress)
    return _attachment(data, _path(call).rpartition("/")[2])


@ROUTES.add(
    "PUT",
    _FILE,
    "Upload a file, or replace it",
    role=Role.ADMINISTER,
    takes_bytes=True,
    max_body=MAX_UPLOAD,
    answer={"path": "/APM/scripts/a.lua", "size": 512},
)
async def _upload(call: Call[None, Wait]) -> dict[str, Any]:
    await call.vehicle.ftp.upload(_path(call), call.data, progress=call.progress)
    return {"path": _path(call), "size": len(call.data)}


@ROUTES.add("DELETE", _FILE, "Remove a file", role=Role.ADMINISTER, answer={"path": "/APM/scripts/a.lua"})
async def _remove(call: PlainCall) -> dict[str, Any]:
    await call.vehicle.ftp.remove(_path(call))
    return {"path": _path(call)}


@ROUTES.add(
    "GET",
    _LOGS,
    "List the logs on a vehicle",
    tag="logs",
    answer={"logs": [{"id": 1, "time": 1790000000, "size": 204800}]},
)
async def _list_logs(call: PlainCall) -> dict[str, Any]:
    vehicle = call.vehicle
    logs = await call.read("logs", vehicle.logs.list)
    return {"logs": [{"id": each.id, "time": each.time_utc, "size": each.size} for each in logs]}


@ROUTES.add("GET", f"{_LOGS}/{{id}}", "Download a log from a vehicle", tag="logs", media_type=_BYTES)
async def _download_log(call: Call[None, Wait]) -> Response:
    log, data = await _read_log(call)
    return _attachment(data, f"vehicle-{call.vehicle.system}-log-{log.id}{_suffix(data)}")


@ROUTES.add(
    "POST",
    f"{_LOGS}/{{id}}",
    "Copy a log from a vehicle to the recordings of the station, for its report page",
    tag="logs",
    role=Role.OPERATE,
    status=201,
    answer={
        "name": "vehicle-1-log-1-2026-11-23-101500.bin",
        "size": 204800,
        "modified": 1790000000.0,
        "running": False,
        "packets": None,
    },
)
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


@ROUTES.add(
    "DELETE", _LOGS, "Erase all logs on a vehicle", tag="logs", role=Role.ADMINISTER, answer={"logs": []}
)
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
