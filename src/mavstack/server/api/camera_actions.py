"""The actions of a camera: images, video, mode, lens, tracking, storage."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Final, Literal

from msgspec import Meta
from msgspec.structs import asdict

from mavstack.dialects import common
from mavstack.http.request_fields import Fields
from mavstack.server.request_types import Timeout

if TYPE_CHECKING:
    from mavstack.node.camera import Camera

Share = Annotated[
    float, Meta(description="Share of the width or height, from 0 (left, top) to 1.", ge=0, le=1)
]
Stream = Annotated[int, Meta(description="The number of the stream.", ge=0, le=255)]
Seconds = Annotated[float, Meta(description="Seconds between two images.", gt=0, le=86400, examples=[2])]
#: The type of a zoom value, and of a focus value, by its name in the API.
ZOOMS: Final = {
    "range": common.CameraZoomType.RANGE,
    "step": common.CameraZoomType.STEP,
    "continuous": common.CameraZoomType.CONTINUOUS,
    "focal-length": common.CameraZoomType.FOCAL_LENGTH,
    "field-of-view": common.CameraZoomType.HORIZONTAL_FOV,
}
FOCUSES: Final = {
    "range": common.SetFocusType.RANGE,
    "step": common.SetFocusType.STEP,
    "continuous": common.SetFocusType.CONTINUOUS,
    "metres": common.SetFocusType.METERS,
    "auto": common.SetFocusType.AUTO,
    "auto-single": common.SetFocusType.AUTO_SINGLE,
    "auto-continuous": common.SetFocusType.AUTO_CONTINUOUS,
}


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
    """Set the mode: photo, video or survey."""

    mode: Annotated[Literal["photo", "video", "survey"], Meta(description="The mode.", examples=["video"])]

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


class StartPhotos(CameraAction):
    """Begin a series of photos."""

    interval: Seconds
    count: Annotated[
        Annotated[int, Meta(ge=1, le=65535)] | None,
        Meta(description="The number of images; null: until the series is ended.", examples=[2]),
    ] = None

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.start_photos(self.interval, count=self.count, timeout=self.timeout)
        return None


class StopPhotos(CameraAction):
    """End a series of photos."""

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.stop_photos(timeout=self.timeout)
        return None


class StartStreaming(CameraAction):
    """Begin to send a video stream."""

    stream: Stream = 1

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.start_streaming(self.stream, timeout=self.timeout)
        return None


class StopStreaming(CameraAction):
    """End a video stream."""

    stream: Stream = 1

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.stop_streaming(self.stream, timeout=self.timeout)
        return None


class SetZoom(CameraAction):
    """Zoom."""

    value: Annotated[
        float,
        Meta(
            description="Percent of the range; by another kind -1 to 1 (step, continuous), mm, or degrees.",
            examples=[50],
        ),
    ]
    kind: Annotated[
        Literal["range", "step", "continuous", "focal-length", "field-of-view"],
        Meta(description="What the value means."),
    ] = "range"

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.set_zoom(self.value, kind=ZOOMS[self.kind], timeout=self.timeout)
        return None


class SetFocus(CameraAction):
    """Focus."""

    value: Annotated[
        float,
        Meta(
            description="Percent of the range; by another kind -1 to 1 (step, continuous), or metres.",
            examples=[50],
        ),
    ] = 0.0
    kind: Annotated[
        Literal["range", "step", "continuous", "metres", "auto", "auto-single", "auto-continuous"],
        Meta(description="What the value means; auto takes none."),
    ] = "range"

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.set_focus(self.value, kind=FOCUSES[self.kind], timeout=self.timeout)
        return None


class TrackPoint(CameraAction):
    """Track a point of the image."""

    x: Share = 0.5
    y: Share = 0.5
    radius: Annotated[float, Meta(description="Share of the width.", ge=0, le=1)] = 0.0

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.track_point(self.x, self.y, radius=self.radius, timeout=self.timeout)
        return None


class TrackRectangle(CameraAction):
    """Track a rectangle of the image."""

    left: Share = 0.25
    top: Share = 0.25
    right: Share = 0.75
    bottom: Share = 0.75

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.track_rectangle(self.left, self.top, self.right, self.bottom, timeout=self.timeout)
        return None


class StopTracking(CameraAction):
    """End the tracking."""

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.stop_tracking(timeout=self.timeout)
        return None


class FormatStorage(CameraAction):
    """Erase a storage of a camera."""

    storage: Annotated[int, Meta(description="The number of the storage.", ge=0, le=255)] = 1
    reset_image_log: Annotated[bool, Meta(description="Count images from 0 again.")] = True

    async def run(self, camera: Camera) -> object:  # noqa: D102
        options = asdict(self)
        await camera.format_storage(options.pop("storage"), **options)
        return None


class ResetSettings(CameraAction):
    """Reset the settings of a camera."""

    async def run(self, camera: Camera) -> object:  # noqa: D102
        await camera.reset_settings(timeout=self.timeout)
        return None


#: The action at the end of each path.
ACTIONS: Final[dict[str, type[CameraAction]]] = {
    "photo": TakePhoto,
    "photos/start": StartPhotos,
    "photos/stop": StopPhotos,
    "mode": SetCameraMode,
    "video/start": StartVideo,
    "video/stop": StopVideo,
    "stream/start": StartStreaming,
    "stream/stop": StopStreaming,
    "zoom": SetZoom,
    "focus": SetFocus,
    "tracking/point": TrackPoint,
    "tracking/rectangle": TrackRectangle,
    "tracking/stop": StopTracking,
    "reset": ResetSettings,
    "format": FormatStorage,
}
#: Actions that erase something.
ADMINISTRATIVE: Final = frozenset({FormatStorage})
