"""The cameras of a vehicle, with the video streams that they announce, and their pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Final

from msgspec import Meta

from mavstack.dialects import common
from mavstack.errors import MavstackError, RemoteTimeout
from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable, Wait, summary_of
from mavstack.security.roles import Role
from mavstack.server.api.camera_actions import ACTIONS, ADMINISTRATIVE, CameraAction
from mavstack.server.api_route import AnyRoute, ApiRoute, Call
from mavstack.server.json_values import to_json
from mavstack.server.request_types import Text

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
        "tracked": to_json(camera.tracked),
        "storages": [to_json(storage) for storage in camera.storages.values()],
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


_SETTINGS_EXAMPLE: Final = {
    "settings": [
        {
            "name": "CAM_MODE",
            "description": "Camera mode",
            "value": 0,
            "options": {"Photo": 0, "Video": 1},
            "minimum": None,
            "maximum": None,
            "step": None,
            "unit": "",
            "readonly": False,
            "is_bool": False,
            "available": True,
        }
    ]
}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "cameras")


@ROUTES.add(
    "GET",
    _CAMERAS,
    "List the cameras of a vehicle and their video streams",
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
    """Ask a camera for its reports; one that lacks a report may have the others."""
    try:
        await camera.get_information()
    except MavstackError:
        return
    for request in (
        camera.get_status,
        camera.get_capture_status,
        camera.list_streams,
        camera.list_storages,
    ):
        try:
            await request()
        except RemoteTimeout:
            return
        except MavstackError:
            continue


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
        role=Role.ADMINISTER if action in ADMINISTRATIVE else Role.OPERATE,
        body=action,
        query=Wait,
        answer={"system": 1, "camera": 100, "image": None},
    )


class CameraSetting(Fields):
    """Set a setting of a camera."""

    value: Annotated[
        float | Text, Meta(description="The name of an option, or the value.", examples=["Photo"])
    ]


def settings_json(camera: Camera) -> dict[str, Any]:
    """Return the settings of a camera as JSON, with the options that remain with the present values."""
    settings, definition = camera.settings, camera.settings.definition
    described = {} if definition is None else definition.settings
    available, values = settings.available, settings.values
    return {
        "settings": [
            {
                "name": name,
                "description": setting.description,
                "value": to_json(values.get(name)),
                "options": to_json(settings.options(name)),
                "minimum": setting.minimum,
                "maximum": setting.maximum,
                "step": setting.step,
                "unit": setting.unit,
                "readonly": setting.readonly,
                "is_bool": setting.is_bool,
                "available": name in available,
            }
            for name, setting in described.items()
        ]
    }


@ROUTES.add(
    "GET",
    f"{_CAMERA}/settings",
    "Download the settings of a camera, with their options",
    answer=_SETTINGS_EXAMPLE,
)
async def _settings(call: Call[None, CamerasQuery]) -> dict[str, Any]:
    """Load the definition and the values once; `cached` answers with the values of now."""
    camera = _camera(call)
    if not (call.query.cached and camera.settings.definition):
        await call.read(f"settings of camera {call.path('camera')}", camera.settings.load)
    return settings_json(camera)


@ROUTES.add(
    "PUT",
    f"{_CAMERA}/settings/{{name}}",
    path_examples={"name": "CAM_MODE"},
    role=Role.OPERATE,
    answer=_SETTINGS_EXAMPLE,
)
async def _set_setting(call: Call[CameraSetting, None]) -> dict[str, Any]:
    camera, value = _camera(call), call.body.value
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    await camera.settings.set(call.path("name"), value)
    return settings_json(camera)


ROUTES.extend((_route(name, action) for name, action in ACTIONS.items()))
