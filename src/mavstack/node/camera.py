"""A camera of a remote component: `component.camera`, `vehicle.camera()`."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.node.api_object import ReadOnly
from mavstack.node.camera_settings import CameraSettings
from mavstack.node.subscription import DEFAULT_QUEUE
from mavstack.services.camera import (
    CameraInformation,
    CameraMonitor,
    CameraStatus,
    CaptureStatus,
    ImageCaptured,
    ListStorages,
    ListStreams,
    RequestReport,
    SetCameraMode,
    TakePhoto,
    commands,
)
from mavstack.services.command import CommandOperation

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.node.clients import ComponentClients
    from mavstack.node.subscription import Subscription
    from mavstack.services import Address, Operation
    from mavstack.services.camera import CapturedImage, Storage, TrackedTarget, VideoStream
    from mavstack.services.command import Command

Result = TypeVar("Result")

_MODE = common.CameraMode
#: Camera modes by their names in the API.
_MODES = {
    "photo": _MODE.IMAGE,
    "image": _MODE.IMAGE,
    "video": _MODE.VIDEO,
    "survey": _MODE.IMAGE_SURVEY,
    "image_survey": _MODE.IMAGE_SURVEY,
}
_ALL = 0


class Camera(ReadOnly):
    """A camera: a component of its own, or one that is attached to the autopilot (camera protocol v2)."""

    device_id: int

    def __init__(self, clients: ComponentClients, device_id: int = 0) -> None:
        self._clients = clients
        #: 1 to 6 for a camera that is attached to the autopilot; 0 for a camera with its own component id.
        self.device_id = device_id
        self._monitor = clients.get(
            CameraMonitor,
            lambda: CameraMonitor(clients.host.address, clients.address, clients.begin_command),
        )

    @property
    def address(self) -> Address:
        """The component of the camera: its system and component id."""
        return self._clients.address

    # Reports that were received

    @property
    def information(self) -> CameraInformation | None:
        """The identity and abilities; None until received (`get_information` requests them)."""
        return self._monitor.reports(self.device_id).information

    @property
    def status(self) -> CameraStatus | None:
        """The last mode, zoom and focus that the camera reported; None until received."""
        return self._monitor.reports(self.device_id).status

    @property
    def capture_status(self) -> CaptureStatus | None:
        """The last report on series of images and recordings; None until received."""
        return self._monitor.reports(self.device_id).capture

    @property
    def tracked(self) -> TrackedTarget | None:
        """The last report on the tracked target; None until received."""
        return self._monitor.reports(self.device_id).tracked

    @property
    def streams(self) -> Mapping[int, VideoStream]:
        """The video streams received so far, by number."""
        return dict(self._monitor.reports(self.device_id).streams)

    @property
    def storages(self) -> Mapping[int, Storage]:
        """The storages received so far, by number."""
        return dict(self._monitor.storages)

    def images(self) -> Subscription[ImageCaptured]:
        """Subscribe to the images that the component's cameras capture, for any reason.

        A lost message is requested again, so that each image arrives once, if the camera keeps a log.

        Returns:
            An async iterator over events with an `image`; close it, or use it as an async context manager.
        """
        return self._clients.host.events(ImageCaptured, of=self._monitor, queue=DEFAULT_QUEUE)

    # Requests

    async def get_information(self, *, timeout: float | None = None) -> CameraInformation:
        """Request the identity and abilities (CAMERA_INFORMATION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The information.

        Raises:
            CommandDenied: The component has no camera.
            MessageTimeout: The component does not answer.
        """
        operation = RequestReport(common.CameraInformation, self.device_id, timeout=timeout)
        return CameraInformation.read(await self._run(operation))

    async def get_status(self, *, timeout: float | None = None) -> CameraStatus:
        """Request the mode, zoom and focus (CAMERA_SETTINGS).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The status.

        Raises:
            CommandDenied: The camera does not report it.
            MessageTimeout: The camera does not answer.
        """
        operation = RequestReport(common.CameraSettings, self.device_id, timeout=timeout)
        return CameraStatus.read(await self._run(operation))

    async def get_capture_status(self, *, timeout: float | None = None) -> CaptureStatus:
        """Request the state of captures (CAMERA_CAPTURE_STATUS).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The status.

        Raises:
            CommandDenied: The camera does not report it.
            MessageTimeout: The camera does not answer.
        """
        operation = RequestReport(common.CameraCaptureStatus, self.device_id, timeout=timeout)
        return CaptureStatus.read(await self._run(operation))

    async def list_storages(self, *, timeout: float | None = None) -> tuple[Storage, ...]:
        """List the storages of the camera's component (STORAGE_INFORMATION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The storages.

        Raises:
            CommandDenied: The component has no storage.
            MessageTimeout: The component does not answer.
        """
        return await self._run(ListStorages(timeout=timeout))

    async def list_streams(self, *, timeout: float | None = None) -> tuple[VideoStream, ...]:
        """List the video streams (VIDEO_STREAM_INFORMATION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The streams.

        Raises:
            CommandDenied: The camera has no video stream.
            MessageTimeout: The camera does not answer.
        """
        return await self._run(ListStreams(self.device_id, timeout=timeout))

    @cached_property
    def settings(self) -> CameraSettings:
        """The settings, with their options from the camera definition file."""
        return CameraSettings(self._clients, self.get_information)

    def __repr__(self) -> str:
        attached = f" device {self.device_id}" if self.device_id else ""
        return f"<Camera {self.address}{attached}>"

    # Images and video

    async def take_photo(self, *, timeout: float | None = None) -> CapturedImage:
        """Take one image, and wait until the camera reports it (MAV_CMD_IMAGE_START_CAPTURE).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The image: its index, place, time and file.

        Raises:
            CommandDenied: The camera refused, such as in video mode.
            CommandTimeout: The camera does not answer.
            MessageTimeout: The camera accepted, and reported no image.
            RemoteDenied: The camera reported that the capture failed.
        """
        number = self._monitor.next_request(self._clients.host.now())
        return await self._run(TakePhoto(self.device_id, number, timeout=timeout))

    async def start_photos(
        self, interval: float, *, count: int | None = None, timeout: float | None = None
    ) -> None:
        """Take a series of images (MAV_CMD_IMAGE_START_CAPTURE); `images` reports each of them.

        Args:
            interval: Seconds between two images.
            count: The number of images; None: until `stop_photos`.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidArgumentError: The interval or the count is not positive.
            CommandDenied: The camera refused.
            CommandTimeout: The camera does not answer.
        """
        if interval <= 0 or (count is not None and count < 1):
            raise InvalidArgumentError(f"a series of images needs a positive interval and count, not {count}")
        await self._command(
            commands.start_images(self.device_id, interval=interval, count=count or 0), timeout
        )

    async def stop_photos(self, *, timeout: float | None = None) -> None:
        """End a series of images (MAV_CMD_IMAGE_STOP_CAPTURE).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The camera refused.
            CommandTimeout: The camera does not answer.
        """
        await self._command(commands.stop_images(self.device_id), timeout)

    async def start_video(
        self, *, stream: int = _ALL, status_rate: float = 1.0, timeout: float | None = None
    ) -> None:
        """Begin a recording (MAV_CMD_VIDEO_START_CAPTURE).

        Args:
            stream: The number of the stream to record; 0: all.
            status_rate: Hertz at which the camera reports `capture_status` meanwhile; 0: not.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidArgumentError: The rate is negative.
            CommandDenied: The camera refused, such as in photo mode.
            CommandTimeout: The camera does not answer.
        """
        command = commands.start_video(self.device_id, stream=stream, status_rate=status_rate)
        await self._command(command, timeout)

    async def stop_video(self, *, stream: int = _ALL, timeout: float | None = None) -> None:
        """End a recording (MAV_CMD_VIDEO_STOP_CAPTURE).

        Args:
            stream: The number of the stream; 0: all.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The camera refused.
            CommandTimeout: The camera does not answer.
        """
        await self._command(commands.stop_video(self.device_id, stream=stream), timeout)

    async def start_streaming(self, stream: int = 1, *, timeout: float | None = None) -> None:
        """Begin to send a video stream (MAV_CMD_VIDEO_START_STREAMING).

        Args:
            stream: The number of the stream.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The camera refused, or has no such stream.
            CommandTimeout: The camera does not answer.
        """
        await self._command(commands.start_streaming(self.device_id, stream), timeout)

    async def stop_streaming(self, stream: int = 1, *, timeout: float | None = None) -> None:
        """End a video stream (MAV_CMD_VIDEO_STOP_STREAMING).

        Args:
            stream: The number of the stream.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The camera refused, or has no such stream.
            CommandTimeout: The camera does not answer.
        """
        await self._command(commands.stop_streaming(self.device_id, stream), timeout)

    # Mode, lens, storage

    async def set_mode(self, mode: str | int, *, wait: bool = True, timeout: float | None = None) -> None:
        """Set the mode (MAV_CMD_SET_CAMERA_MODE), and wait until the camera reports it (CAMERA_SETTINGS).

        A camera that refuses to report its mode is trusted.

        Args:
            mode: "photo", "video", "survey", or a CAMERA_MODE.
            wait: Wait for the report. MAVSDK's camera server reports the photo mode in every mode.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidArgumentError: There is no such mode.
            CommandDenied: The camera refused, such as while it records.
            CommandTimeout: The camera does not answer.
            MessageTimeout: The camera accepted, and does not answer any more.
            ModeTimeout: The camera accepted the mode and did not enter it.
        """
        number = _MODES.get(mode.casefold()) if isinstance(mode, str) else mode
        if number is None:
            raise InvalidArgumentError(f"a camera mode is photo, video or survey, got {mode!r}")
        await self._run(SetCameraMode(self.device_id, number, confirm=wait, timeout=timeout))

    async def set_zoom(
        self, value: float, *, kind: int = common.CameraZoomType.RANGE, timeout: float | None = None
    ) -> None:
        """Zoom (MAV_CMD_SET_CAMERA_ZOOM).

        Args:
            value: Percent of the range, 0 to 100; of another kind, what that kind means.
            kind: A CAMERA_ZOOM_TYPE: RANGE, STEP or CONTINUOUS (-1 to 1), FOCAL_LENGTH (mm), HORIZONTAL_FOV
                (degrees).
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidArgumentError: The value is out of range.
            CommandDenied: The camera refused.
            CommandTimeout: The camera does not answer.
        """
        await self._command(commands.set_zoom(self.device_id, value, kind), timeout)

    async def set_focus(
        self, value: float = 0.0, *, kind: int = common.SetFocusType.RANGE, timeout: float | None = None
    ) -> None:
        """Focus (MAV_CMD_SET_CAMERA_FOCUS).

        Args:
            value: Percent of the range, 0 to 100; of another kind, what that kind means.
            kind: A SET_FOCUS_TYPE: RANGE, STEP or CONTINUOUS (-1 to 1), METERS, or one of AUTO.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidArgumentError: The value is out of range.
            CommandDenied: The camera refused.
            CommandTimeout: The camera does not answer.
        """
        await self._command(commands.set_focus(self.device_id, value, kind), timeout)

    async def format_storage(
        self, storage: int = 1, *, reset_image_log: bool = True, timeout: float | None = None
    ) -> None:
        """Erase a storage (MAV_CMD_STORAGE_FORMAT).

        Args:
            storage: The number of the storage.
            reset_image_log: Count images from 0 again.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The camera refused, or has no such storage.
            CommandTimeout: The camera does not answer.
        """
        await self._command(commands.format_storage(storage, reset_image_log=reset_image_log), timeout)

    async def reset_settings(self, *, timeout: float | None = None) -> None:
        """Reset the settings of the camera (MAV_CMD_RESET_CAMERA_SETTINGS).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The camera refused.
            CommandTimeout: The camera does not answer.
        """
        await self._command(commands.reset_settings(self.device_id), timeout)

    # Tracking

    async def track_point(
        self, x: float, y: float, *, radius: float = 0.0, timeout: float | None = None
    ) -> None:
        """Track a point of the image (MAV_CMD_CAMERA_TRACK_POINT).

        Args:
            x: Share of the width, 0 (left) to 1.
            y: Share of the height, 0 (top) to 1.
            radius: Share of the width, 0 to 1.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidArgumentError: A value is not from 0 to 1.
            CommandDenied: The camera refused.
            CommandTimeout: The camera does not answer.
        """
        await self._command(commands.track_point(self.device_id, x, y, radius), timeout)

    async def track_rectangle(
        self, left: float, top: float, right: float, bottom: float, *, timeout: float | None = None
    ) -> None:
        """Track a rectangle of the image (MAV_CMD_CAMERA_TRACK_RECTANGLE).

        Args:
            left: Share of the width, 0 to 1.
            top: Share of the height, 0 to 1; y grows downwards.
            right: Share of the width, 0 to 1.
            bottom: Share of the height, 0 to 1.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidArgumentError: A value is not from 0 to 1, or the rectangle is empty.
            CommandDenied: The camera refused.
            CommandTimeout: The camera does not answer.
        """
        command = commands.track_rectangle(self.device_id, left, top, right, bottom)
        await self._command(command, timeout)

    async def stop_tracking(self, *, timeout: float | None = None) -> None:
        """End the tracking (MAV_CMD_CAMERA_STOP_TRACKING).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The camera refused.
            CommandTimeout: The camera does not answer.
        """
        await self._command(commands.stop_tracking(self.device_id), timeout)

    async def _command(self, command: Command, timeout: float | None) -> None:
        await self._run(CommandOperation(command, timeout=timeout))

    async def _run(self, operation: Operation[Result]) -> Result:
        return await self._clients.host.run_operation(self._clients.command, operation)
