"""Video of cameras for browsers: WebRTC by one request (WHEP), from RTSP and RTP."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING, Annotated, Any

from msgspec import Meta
from starlette.responses import Response

from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.video.addresses import MAX_LENGTH, read_address

if TYPE_CHECKING:
    from typing import Final

_SDP = "application/sdp"
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


async def _show(call: PlainCall) -> dict[str, Any]:
    return {"available": find_spec("aiortc") is not None, "viewers": call.station.video_viewers}


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


async def _leave(call: PlainCall) -> dict[str, int]:
    # No error for an unknown viewer: its connection may have been closed before.
    await call.station.video().leave(call.path("viewer"))
    return {"viewers": call.station.video_viewers}


ROUTES: tuple[AnyRoute, ...] = (
    ApiRoute(
        method="GET",
        path="/api/video",
        handler=_show,
        summary="Return whether the station plays cameras, and how many viewers watch",
        tag="cameras",
        answer={"available": True, "viewers": 1},
    ),
    ApiRoute(
        method="POST",
        path="/api/video/whep",
        handler=_watch,
        summary="Watch a camera by WebRTC: the body is the offer, the answer its session description (WHEP)",
        tag="cameras",
        query=WatchQuery,
        takes_bytes=True,
        max_body=MAX_OFFER,
        status=201,
        media_type=_SDP,
    ),
    ApiRoute(
        method="DELETE",
        path="/api/video/whep/{viewer}",
        path_examples={"viewer": "Zk3bR0"},
        handler=_leave,
        summary="End watching a camera",
        tag="cameras",
        answer={"viewers": 0},
    ),
)
