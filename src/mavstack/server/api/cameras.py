"""The cameras of a vehicle, with the video streams that they announce, and their pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.dialects import common
from mavstack.errors import MavstackError
from mavstack.http.bodies import RefusedError
from mavstack.security.roles import Role
from mavstack.server.api_route import ApiRoute, Call
from mavstack.server.fields import Field
from mavstack.server.json_values import to_json

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from mavstack.node.camera import Camera
    from mavstack.services.camera.media import VideoStream
    from mavstack.vehicle import Vehicle

_CAMERAS: Final = "/api/vehicles/{system}/cameras"
_CAMERA: Final = f"{_CAMERAS}/{{camera}}"
MAX_CAMERA: Final = 255
_TYPE, _ENCODING = common.VideoStreamType, common.VideoStreamEncoding


def camera_json(camera: Camera) -> dict[str, Any]:
    """Return a camera as JSON, as far as it is known."""
    information = camera.information
    return {
        "id": camera.device_id or camera.address.component,
        "component": camera.address.component,
        "information": to_json(information),
        "status": to_json(camera.status),
        "capture": to_json(camera.capture_status),
        "streams": [_stream(stream) for stream in camera.streams.values()],
    }


def _stream(stream: VideoStream) -> dict[str, Any]:
    kinds: dict[str, Any] = {"type": stream.type, "encoding": stream.encoding}
    if stream.type in _TYPE.__members__.values():
        kinds["type"] = _TYPE(stream.type).name
    if stream.encoding in _ENCODING.__members__.values():
        kinds["encoding"] = _ENCODING(stream.encoding).name
    return {**to_json(stream), **kinds}


async def _list(call: Call) -> list[dict[str, Any]]:
    """Ask for the cameras; one that does not answer is shown as far as it is known."""
    vehicle = call.vehicle
    cameras = vehicle.cameras
    if not call.query["cached"]:
        try:
            cameras = await call.read("cameras", lambda: _find(vehicle))
        except MavstackError:
            cameras = vehicle.cameras
    return [camera_json(camera) for camera in cameras]


async def _find(vehicle: Vehicle) -> tuple[Camera, ...]:
    """Return the cameras of a vehicle, with their present settings."""
    cameras = await vehicle.find_cameras()
    for camera in cameras:
        await _ask(camera)
    return cameras


async def _ask(camera: Camera) -> None:
    for request in (camera.get_information, camera.list_streams, camera.get_capture_status):
        try:
            await request()
        except MavstackError:
            return


async def _take_photo(camera: Camera, body: dict[str, Any]) -> object:
    return await camera.take_photo(timeout=body["timeout"])


async def _set_mode(camera: Camera, body: dict[str, Any]) -> None:
    await camera.set_mode(body["mode"], timeout=body["timeout"])


async def _start_video(camera: Camera, body: dict[str, Any]) -> None:
    await camera.start_video(timeout=body["timeout"])


async def _stop_video(camera: Camera, body: dict[str, Any]) -> None:
    await camera.stop_video(timeout=body["timeout"])


def _camera(call: Call) -> Camera:
    text = call.path("camera")
    if not (text.isascii() and text.isdigit() and 1 <= int(text[:6]) <= MAX_CAMERA):
        raise RefusedError(404, f"ids of cameras are numbers from 1 to {MAX_CAMERA}")
    return call.vehicle.camera(int(text))


def _route(
    name: str,
    action: Callable[[Camera, dict[str, Any]], Awaitable[object]],
    summary: str,
    *fields: Field,
) -> ApiRoute:
    async def handler(call: Call) -> dict[str, Any]:
        camera = _camera(call)
        answer = await action(camera, call.body)
        return {"system": call.vehicle.system, "camera": int(call.path("camera")), "image": to_json(answer)}

    return ApiRoute(
        method="POST",
        path=f"{_CAMERA}/{name}",
        handler=handler,
        summary=summary,
        tag="cameras",
        role=Role.OPERATE,
        body=(*fields, Field(name="timeout", about="Seconds for the whole call; null: no limit.", minimum=0)),
        is_long=True,
        answer={"system": 1, "camera": 100, "image": None},
    )


ROUTES: Final = (
    ApiRoute(
        method="GET",
        path=_CAMERAS,
        handler=_list,
        summary="List the cameras of a vehicle and their video streams",
        tag="cameras",
        query=(
            Field(
                name="cached",
                type="boolean",
                about="Answer with what is known, without asking the vehicle.",
                default=False,
            ),
        ),
        is_long=True,
        answer=[
            {
                "id": 100,
                "component": 100,
                "information": {"vendor": "Mavstack", "model": "Simulated camera"},
                "status": None,
                "capture": None,
                "streams": [{"id": 1, "uri": "rtsp://192.168.1.10:554/live", "type": "RTSP"}],
            }
        ],
    ),
    _route("photo", _take_photo, "Take a photo"),
    _route(
        "mode",
        _set_mode,
        "Set the mode: photo or video",
        Field(
            name="mode",
            type="string",
            about="The mode.",
            required=True,
            choices=("photo", "video"),
            example="video",
        ),
    ),
    _route("video/start", _start_video, "Begin a video"),
    _route("video/stop", _stop_video, "End a video"),
)
