"""The actions of a camera: images, video, mode, lens, storage, tracking."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.camera import SetCameraMode, TakePhoto, commands
from mavstack.services.command import CommandOperation

if TYPE_CHECKING:
    from mavstack.node.clients import ComponentClients
    from mavstack.services import Operation
    from mavstack.services.camera import CapturedImage
    from mavstack.services.command import Command

Result = TypeVar("Result")

_MODE = common.CameraMode
#: The modes by the names that people use.
_MODES = {
    "photo": _MODE.IMAGE,
    "image": _MODE.IMAGE,
    "video": _MODE.VIDEO,
    "survey": _MODE.IMAGE_SURVEY,
    "image_survey": _MODE.IMAGE_SURVEY,
}
_ALL = 0


class CameraActions:
    """The part of a camera that makes it do something; see `Camera`."""

    _clients: ComponentClients
    device_id: int

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
        number = self._clients.cameras.next_request(self._clients.host.now())
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
