"""The cameras of a vehicle, with the video streams that they announce, and their pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from msgspec import Meta

from mavstack.dialects import common
from mavstack.errors import MavstackError
from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import Wait
from mavstack.security.roles import Role
from mavstack.server.api.action_route import summary_of
from mavstack.server.api_route import AnyRoute, ApiRoute, Call
from mavstack.server.json_values import to_json
from mavstack.server.request_types import Timeout

if TYPE_CHECKING:
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


class CamerasQuery(Wait):
    """The query of the list of cameras."""

    cached: Annotated[bool, Meta(description="Answer with what is known, without asking the vehicle.")] = (
        False
    )


async def _list(call: Call[None, CamerasQuery]) -> list[dict[str, Any]]:
    """Ask for the cameras; one that does not answer is shown as far as it is known."""
    vehicle = call.vehicle
    cameras = vehicle.cameras
    if not call.query.cached:
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


class CameraAction(Fields, kw_only=True):
    """An action of a camera: its fields are the body of the request."""

    timeout: Timeout = None

    async def run(self, camera: Camera) -> object:
        """Carry it out, and return the image if there is one."""
        raise NotImplementedError


class TakePhoto(CameraAction):
    """Take a photo."""

    async def run(self, camera: Camera) -> object:  # noqa: D102
        return await camera.take_photo(timeout=self.timeout)


class SetCameraMode(CameraAction):
    """Set the mode: photo or video."""

    mode: Annotated[Literal["photo", "video"], Meta(description="The mode.", examples=["video"])]

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.set_mode(self.mode, timeout=self.timeout)
        return None


class StartVideo(CameraAction):
    """Begin a video."""

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.start_video(timeout=self.timeout)
        return None


class StopVideo(CameraAction):
    """End a video."""

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.stop_video(timeout=self.timeout)
        return None


def _camera(call: Call[Any, Any]) -> Camera:
    text = call.path("camera")
    if not (text.isascii() and text.isdigit() and 1 <= int(text[:6]) <= MAX_CAMERA):
        raise RefusedError(404, f"ids of cameras are numbers from 1 to {MAX_CAMERA}")
    return call.vehicle.camera(int(text))


def _route(name: str, action: type[CameraAction]) -> ApiRoute[CameraAction, Wait]:
    async def handler(call: Call[CameraAction, Wait]) -> dict[str, Any]:
        image = await call.body.run(_camera(call))
        return {"system": call.vehicle.system, "camera": int(call.path("camera")), "image": to_json(image)}

    return ApiRoute(
        method="POST",
        path=f"{_CAMERA}/{name}",
        handler=handler,
        summary=summary_of(action),
        tag="cameras",
        role=Role.OPERATE,
        body=action,
        query=Wait,
        answer={"system": 1, "camera": 100, "image": None},
    )


ROUTES: Final[tuple[AnyRoute, ...]] = (
    ApiRoute(
        method="GET",
        path=_CAMERAS,
        handler=_list,
        summary="List the cameras of a vehicle and their video streams",
        tag="cameras",
        query=CamerasQuery,
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
    _route("photo", TakePhoto),
    _route("mode", SetCameraMode),
    _route("video/start", StartVideo),
    _route("video/stop", StopVideo),
)
