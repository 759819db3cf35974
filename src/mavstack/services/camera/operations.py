"""Operations on a camera; all of them run on the `CommandClient` of its component.

TakePhoto    CAMERA_CAPTURE_STATUS: how many images ── IMAGE_START_CAPTURE ── accepted
               ── CAMERA_IMAGE_CAPTURED ─────────────────────────► result
               └── silence ── CAMERA_CAPTURE_STATUS: one more? ── the image by its index ──► result

SetMode      SET_CAMERA_MODE ── accepted ── CAMERA_SETTINGS, until it has the mode ──► result
                                   ├── refused: the camera reports no mode ─────────► result
                                   └── another mode, some times ────────────────────► ModeTimeout
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import CommandDenied, CommandTimeout, MessageTimeout, ModeTimeout, RemoteDenied
from mavstack.services.addressing import message_ids
from mavstack.services.camera import commands
from mavstack.services.camera.media import CapturedImage, VideoStream
from mavstack.services.camera.reports import CameraInformation, CaptureStatus, Storage
from mavstack.services.command import CommandOperation
from mavstack.services.message_request import ListInstances, RequestMessage
from mavstack.services.operation import Operation
from mavstack.services.pause import Pause
from mavstack.services.procedure import Procedure

if TYPE_CHECKING:
    from collections.abc import Generator

    from mavstack.wire import Packet

#: Seconds to wait for CAMERA_IMAGE_CAPTURED before the message is requested from the camera.
IMAGE_TIMEOUT = 3.0
#: The number of these waits after which the operation fails.
MAX_IMAGE_ROUNDS = 10
#: Seconds between two requests of CAMERA_SETTINGS, which show whether the camera has changed its mode.
MODE_INTERVAL = 0.5
#: The largest number of these requests.
MAX_MODE_ROUNDS = 12
STATUS_TIMEOUT = 10.0


class ListCameras(Procedure[tuple[CameraInformation, ...]]):
    """The listing of the cameras of a component: itself, or those attached to an autopilot.

    The result is empty if the component refuses CAMERA_INFORMATION, because it has no camera.
    """

    timeout_error = MessageTimeout

    def __init__(self, *, timeout: float | None = None) -> None:
        super().__init__("listing the cameras of", timeout=timeout, idle_timeout=60.0)

    def steps(self) -> Generator[Operation[Any], Any, tuple[CameraInformation, ...]]:
        try:
            found = yield ListInstances(
                common.CameraInformation, lambda message: int(message.camera_device_id)
            )
        except CommandDenied:
            return ()
        return tuple(CameraInformation.read(message) for message in found.values())


class ListStorages(Procedure[tuple[Storage, ...]]):
    """The listing of the storages of a camera's component (STORAGE_INFORMATION)."""

    timeout_error = MessageTimeout

    def __init__(self, *, timeout: float | None = None) -> None:
        super().__init__("listing the storages of", timeout=timeout, idle_timeout=60.0)

    def steps(self) -> Generator[Operation[Any], Any, tuple[Storage, ...]]:
        found = yield ListInstances(
            common.StorageInformation,
            lambda message: int(message.storage_id),
            lambda message: int(message.storage_count),
        )
        return tuple(Storage.read(message) for message in found.values() if message.storage_id)


class ListStreams(Procedure[tuple[VideoStream, ...]]):
    """The listing of the video streams of a camera (VIDEO_STREAM_INFORMATION)."""

    timeout_error = MessageTimeout

    def __init__(self, device_id: int, *, timeout: float | None = None) -> None:
        super().__init__("listing the video streams of", timeout=timeout, idle_timeout=60.0)
        self._device_id = device_id

    def steps(self) -> Generator[Operation[Any], Any, tuple[VideoStream, ...]]:
        found = yield ListInstances(
            common.VideoStreamInformation,
            lambda message: int(message.stream_id),
            lambda message: int(message.count),
        )
        streams = (VideoStream.read(message) for message in found.values() if message.stream_id)
        return tuple(stream for stream in streams if stream.device_id == self._device_id)


class RequestReport(RequestMessage):
    """The request of a message of one camera: `message` has a field `camera_device_id`."""

    def __init__(self, message: type[Any], device_id: int, *, timeout: float | None = None) -> None:
        super().__init__(
            message,
            (float(device_id),),
            match=lambda report: report.camera_device_id == device_id,
            timeout=timeout,
        )


class TakePhoto(Procedure[CapturedImage]):
    """The capture of one image; the result is the image as the camera reports it.

    Args:
        device_id: The attached camera, or 0.
        sequence: The number of the request, from 1: a camera that gets a number twice takes one image.
        timeout: Seconds for the whole operation; None sets no overall limit.
    """

    timeout_error = MessageTimeout
    handles = message_ids(common.CameraImageCaptured)

    def __init__(self, device_id: int, sequence: int, *, timeout: float | None = None) -> None:
        super().__init__("taking a photo with", timeout=timeout, idle_timeout=60.0)
        self._device_id, self._sequence = device_id, sequence
        self._image: CapturedImage | None = None
        self._first = 0
        self._asked = False

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.CameraImageCaptured(camera_id=number) as message if number == self._device_id:
                image = CapturedImage.read(message)
                if self._asked and (image.index >= self._first or image.index < 0):
                    self._image = self._image or image

    def steps(self) -> Generator[Operation[Any], Any, CapturedImage]:
        before = yield from self._count()
        self._first, self._asked = before or 0, True
        yield CommandOperation(commands.start_images(self._device_id, sequence=self._sequence))
        for _ in range(MAX_IMAGE_ROUNDS):
            yield _Until(self, IMAGE_TIMEOUT)
            if self._image is None and before is not None:
                yield from self._request_lost(before)
            if self._image is not None:
                return self._checked(self._image)
        answer = "accepted, but the camera reported no image"
        raise MessageTimeout(self.description, str(self.target), attempts=self.attempts, answer=answer)

    @property
    def has_image(self) -> bool:
        """True once the image was reported."""
        return self._image is not None

    def _count(self) -> Generator[Operation[Any], Any, int | None]:
        """Return the number of images so far; None if the camera does not tell."""
        try:
            message = yield RequestReport(common.CameraCaptureStatus, self._device_id, timeout=STATUS_TIMEOUT)
        except (CommandDenied, CommandTimeout, MessageTimeout):
            return None
        return max(CaptureStatus.read(message).image_count, 0)

    def _request_lost(self, before: int) -> Generator[Operation[Any], Any, None]:
        count = yield from self._count()
        if count is None or count <= before:
            return
        try:
            yield RequestMessage(
                common.CameraImageCaptured,
                (float(before),),
                match=lambda message: message.image_index >= before,
                timeout=STATUS_TIMEOUT,
            )
        except (CommandDenied, CommandTimeout, MessageTimeout):
            return  # the message may still arrive, and `receive` reads it then

    def _checked(self, image: CapturedImage) -> CapturedImage:
        if not image.success:
            raise RemoteDenied(
                self.description,
                str(self.target),
                attempts=self.attempts,
                answer="the camera reports that the capture failed",
                code=common.MavResult.FAILED,
            )
        return image


class _Until(Operation[None]):
    """The wait for the image of a `TakePhoto`; ends after some seconds without one too."""

    handles = message_ids(common.CameraImageCaptured)

    def __init__(self, photo: TakePhoto, seconds: float) -> None:
        super().__init__("waiting for an image of", idle_timeout=seconds + 1.0)
        self._photo, self._seconds = photo, seconds

    def start(self, now: float) -> None:
        self.timer = now + self._seconds
        self._check()

    def receive(self, packet: Packet, now: float) -> None:
        self._check()

    def handle_timeout(self, now: float) -> None:
        self.finish(None)

    def _check(self) -> None:
        if self._photo.has_image:
            self.finish(None)


class SetCameraMode(Procedure[int]):
    """The setting of a CAMERA_MODE, which the camera's CAMERA_SETTINGS confirm.

    Args:
        device_id: The attached camera, or 0.
        mode: The CAMERA_MODE.
        confirm: Wait until the camera reports the mode, unless it reports none.
        timeout: Seconds for the whole operation; None sets no overall limit.
    """

    timeout_error = ModeTimeout

    def __init__(
        self, device_id: int, mode: int, *, confirm: bool = True, timeout: float | None = None
    ) -> None:
        super().__init__(f"setting mode {mode_name(mode)} of", timeout=timeout, idle_timeout=60.0)
        self._device_id, self._mode, self._confirm = device_id, int(mode), confirm

    def steps(self) -> Generator[Operation[Any], Any, int]:
        yield CommandOperation(commands.set_mode(self._device_id, self._mode))
        if not self._confirm:
            return self._mode
        for _ in range(MAX_MODE_ROUNDS):
            try:
                report = yield RequestReport(common.CameraSettings, self._device_id)
            except CommandDenied:
                return self._mode  # the camera does not report its mode
            if report.mode_id == self._mode:
                return self._mode
            yield Pause(MODE_INTERVAL)
        answer = f"accepted, but the camera reports mode {mode_name(report.mode_id)}"
        raise ModeTimeout(self.description, str(self.target), attempts=self.attempts, answer=answer)


def mode_name(mode: int) -> str:
    """Return the name of a CAMERA_MODE in lower case, or its number."""
    known = {int(each): each.name.lower() for each in common.CameraMode}
    return known.get(int(mode), str(int(mode)))
