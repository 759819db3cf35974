"""Video of cameras for browsers: WebRTC by one request (WHEP), from RTSP and RTP."""

from __future__ import annotations

import asyncio
from importlib.util import find_spec
from typing import Annotated, Any, Final

from msgspec import Meta
from starlette.responses import FileResponse, Response

from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import NoFields, RouteTable
from mavstack.security.roles import Role
from mavstack.server.api.recordings import file_so_far
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.video.addresses import MAX_LENGTH, read_address
from mavstack.server.video.recordings import label_of

_SDP = "application/sdp"
_MP4: Final = "video/mp4"
_EXAMPLE: Final = {
    "name": "copter-1-front-2026-11-28-101500.mp4",
    "size": 51200,
    "modified": 1790000000.0,
    "running": True,
    "seconds": 12.5,
    "lost": 0,
    "problem": "",
    "uri": "rtsp://127.0.0.1:8554/camera",
}
#: Number of viewers from which observers cannot watch, so that operators still can.
MAX_OBSERVED: Final = 8
#: Maximum size of a WebRTC offer in bytes.
MAX_OFFER: Final = 1 << 16


class WatchQuery(Fields):
    """The camera to watch."""

    uri: Annotated[
        str,
        Meta(
            description="The address: rtsp://, rtsps://, rtp:// or udp:// with a port, or a port alone.",
            examples=["rtsp://192.168.1.10:8554/front"],
            max_length=MAX_LENGTH,
        ),
    ]
    h265: Annotated[bool, Meta(description="An RTP stream is H.265, which its packets do not say.")] = False


class RecordVideo(Fields):
    """Record a camera of a vehicle."""

    uri: Annotated[
        str,
        Meta(
            description="The address: rtsp://, rtsps://, rtp:// or udp:// with a port, or a port alone.",
            examples=["rtsp://127.0.0.1:8554/camera"],
            max_length=MAX_LENGTH,
        ),
    ]
    system: Annotated[
        Annotated[int, Meta(ge=1, le=255)] | None,
        Meta(description="The system id of the vehicle, for the name of the file; null: none.", examples=[1]),
    ] = None
    name: Annotated[
        str,
        Meta(
            description="The name of the stream, for the name of the file.", examples=["Front"], max_length=80
        ),
    ] = ""
    h265: Annotated[bool, Meta(description="An RTP stream is H.265, which its packets do not say.")] = False


ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "cameras")


@ROUTES.add(
    "GET",
    "/api/video",
    "Return whether the station plays cameras, and how many viewers watch",
    answer={"available": True, "viewers": 1},
)
async def _show(call: PlainCall) -> dict[str, Any]:
    return {"available": find_spec("aiortc") is not None, "viewers": call.station.video_viewers}


@ROUTES.add(
    "POST",
    "/api/video/whep",
    "Watch a camera by WebRTC: the body is the offer, the answer its session description (WHEP)",
    takes_bytes=True,
    max_body=MAX_OFFER,
    status=201,
    media_type=_SDP,
)
async def _watch(call: Call[None, WatchQuery]) -> Response:
    address = read_address(call.query.uri, is_h265=call.query.h265)
    gateway = call.station.video()
    if call.role is Role.OBSERVE:
        if not gateway.plays(address):
            raise RefusedError(403, "observers watch cameras that are open: an operator opens this one first")
        if gateway.viewers >= MAX_OBSERVED:
            raise RefusedError(503, f"{gateway.viewers} viewers watch already: only operators may join")
    answer = await gateway.watch(address, call.data.decode("utf-8", "replace"))
    headers = {"Location": f"/api/video/whep/{answer.name}"}
    return Response(answer.sdp, status_code=201, media_type=_SDP, headers=headers)


@ROUTES.add(
    "DELETE",
    "/api/video/whep/{viewer}",
    "End watching a camera",
    path_examples={"viewer": "Zk3bR0"},
    answer={"viewers": 0},
)
async def _leave(call: PlainCall) -> dict[str, int]:
    # No error for an unknown viewer: its connection may have been closed before.
    await call.station.video().leave(call.path("viewer"))
    return {"viewers": call.station.video_viewers}


@ROUTES.add("GET", "/api/video/recordings", "List the recorded videos of the station", answer=[_EXAMPLE])
async def _list(call: PlainCall) -> list[dict[str, Any]]:
    return await asyncio.to_thread(call.station.videos.list)


@ROUTES.add("POST", "/api/video/recordings", role=Role.OPERATE, status=201, answer=_EXAMPLE)
async def _record(call: Call[RecordVideo, None]) -> dict[str, Any]:
    body = call.body
    address = read_address(body.uri, is_h265=body.h265)
    vehicle = call.station.connection.vehicles.get(body.system) if body.system is not None else None
    words = [] if vehicle is None else [str(vehicle.vehicle_type), str(vehicle.system)]
    return await call.station.videos.start(address, body.uri, label_of(*words, body.name))


@ROUTES.add(
    "POST",
    "/api/video/recordings/{name}/stop",
    "End the recording of a camera",
    path_examples={"name": "copter-1-front-2026-11-28-101500.mp4"},
    role=Role.OPERATE,
    answer=_EXAMPLE | {"running": False},
)
async def _stop(call: Call[NoFields, None]) -> dict[str, Any]:
    return await call.station.videos.stop(call.path("name"))


@ROUTES.add(
    "GET",
    "/api/video/recordings/{name}",
    "Download a recorded video",
    path_examples={"name": "copter-1-front-2026-11-28-101500.mp4"},
    media_type=_MP4,
)
async def _download(call: PlainCall) -> Response:
    videos, name = call.station.videos, call.path("name")
    path = videos.path(name)
    if videos.is_growing(name):
        return file_so_far(path, _MP4)
    return FileResponse(path, filename=path.name, media_type=_MP4)
