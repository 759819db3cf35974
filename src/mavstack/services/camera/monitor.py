"""The monitor of the cameras of one component: their last reports, and every image that they captured.

CAMERA_IMAGE_CAPTURED carries an index, and CAMERA_CAPTURE_STATUS the number of images. An index that was
skipped, or a count that is ahead, shows that a message was lost: then it is requested again by its index, so
that each image is reported once. Images from before the first message are not requested. A count that
decreases means that the camera reset its image log.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.camera.media import CapturedImage, TrackedTarget, VideoStream
from mavstack.services.camera.reports import CameraInformation, CameraStatus, CaptureStatus, Storage
from mavstack.services.message_request import RequestMessage
from mavstack.services.service import Event, Service

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.operation import Operation
    from mavstack.wire import Packet

#: An autopilot has at most this many attached cameras (guide: camera protocol).
MAX_CAMERAS = 7
MAX_STREAMS = MAX_STORAGES = 32
#: The largest number of missing images that are requested; the oldest images of a longer gap are not
#: requested.
MAX_MISSING = 200
#: The largest number of concurrent requests for missing images.
MAX_REQUESTS = 4
#: Timeout of a request for a missing image, in seconds.
REQUEST_TIMEOUT = 20.0
#: The largest request number: it is sent as a float32, which holds integers exactly up to twice this number.
MAX_REQUEST = 8_000_000


@dataclass(frozen=True, slots=True)
class CameraFound(Event):
    """A camera told of itself for the first time (CAMERA_INFORMATION)."""

    source: Address
    information: CameraInformation


@dataclass(frozen=True, slots=True)
class ImageCaptured(Event):
    """A camera captured an image; each image is reported once, lost messages included."""

    source: Address
    image: CapturedImage


@dataclass(frozen=True, slots=True)
class CaptureStatusChanged(Event):
    """A camera began or ended a series of images or a recording, or took an image."""

    source: Address
    status: CaptureStatus


class CameraReports:
    """The last reports of one camera; None until received."""

    def __init__(self, device_id: int = 0) -> None:
        self.device_id = device_id
        self.information: CameraInformation | None = None
        self.status: CameraStatus | None = None
        self.capture: CaptureStatus | None = None
        self.tracked: TrackedTarget | None = None
        self.streams: dict[int, VideoStream] = {}
        #: The index of the next image; None until the first report.
        self.next_image: int | None = None
        #: When the newest image was taken, milliseconds since the camera booted.
        self.newest_image_at = 0
        self.missing: dict[int, None] = {}
        self.requested: set[int] = set()


class CameraMonitor(Service):
    """The cameras of one component.

    Args:
        local: The local component.
        target: The component of the cameras.
        begin: Begins an operation on the target's `CommandClient`; None: missing images are not requested.
    """

    handles = message_ids(
        common.CameraInformation,
        common.CameraSettings,
        common.CameraCaptureStatus,
        common.CameraImageCaptured,
        common.CameraTrackingImageStatus,
        common.StorageInformation,
        common.VideoStreamInformation,
        common.VideoStreamStatus,
    )

    def __init__(
        self, local: Address, target: Address, begin: Callable[[Operation[Any], float], None] | None = None
    ) -> None:
        super().__init__(local)
        self.target = self.source_filter = target
        self._begin = begin
        self._cameras: dict[int, CameraReports] = {}
        self._last_request = 0
        #: The storages of the component, by id.
        self.storages: dict[int, Storage] = {}

    def reports(self, device_id: int = 0) -> CameraReports:
        """Return the last reports of a camera."""
        return self._cameras.get(device_id) or CameraReports()

    def next_request(self, now: float) -> int:
        """Return the number of a request for a single image; a camera that gets one twice takes one image.

        It follows the time in milliseconds, so that a program that is started again repeats no number.
        """
        self._last_request = max(self._last_request + 1, 1 + int(now * 1e3) % MAX_REQUEST)
        return self._last_request

    @property
    def device_ids(self) -> tuple[int, ...]:
        """The device ids of the cameras whose CAMERA_INFORMATION was received."""
        known = (number for number, each in self._cameras.items() if each.information is not None)
        return tuple(sorted(known))

    def clear_cache(self, now: float) -> None:
        """Discard all state, because the component rebooted."""
        self._cameras.clear()
        self.storages.clear()

    def receive(self, packet: Packet, now: float) -> None:
        message = packet.message
        match message:
            case common.CameraImageCaptured(camera_id=number):
                camera = self._camera(number)
            case common.StorageInformation() as storage:
                if storage.storage_id in self.storages or len(self.storages) < MAX_STORAGES:
                    self.storages[storage.storage_id] = Storage.read(storage)
                return
            case _:
                camera = self._camera(getattr(message, "camera_device_id", 0))
        if camera is not None:
            self._learn(camera, message, now)

    def _camera(self, number: int) -> CameraReports | None:
        if number not in self._cameras and len(self._cameras) >= MAX_CAMERAS:
            return None
        return self._cameras.setdefault(number, CameraReports(number))

    def _learn(self, camera: CameraReports, message: object, now: float) -> None:
        match message:
            case common.CameraInformation() as information:
                first, camera.information = camera.information is None, CameraInformation.read(information)
                if first:
                    self.emit(CameraFound(self.target, camera.information))
            case common.CameraSettings() as settings:
                camera.status = CameraStatus.read(settings)
            case common.CameraCaptureStatus() as status:
                self._capture_status(camera, CaptureStatus.read(status), status.time_boot_ms, now)
            case common.CameraImageCaptured() as captured:
                self._image(camera, CapturedImage.read(captured), captured.time_boot_ms, now)
            case common.CameraTrackingImageStatus() as tracking:
                camera.tracked = TrackedTarget.read(tracking)
            case common.VideoStreamInformation() as stream:
                if stream.stream_id in camera.streams or len(camera.streams) < MAX_STREAMS:
                    camera.streams[stream.stream_id] = VideoStream.read(stream)
            case common.VideoStreamStatus() as update if update.stream_id in camera.streams:
                camera.streams[update.stream_id] = camera.streams[update.stream_id].updated(update)

    # Images

    def _capture_status(self, camera: CameraReports, status: CaptureStatus, at: int, now: float) -> None:
        before, camera.capture = camera.capture, status
        count, following = max(status.image_count, 0), camera.next_image
        if following is None or (count < following and at > camera.newest_image_at):
            self._restart(camera, count)
        elif count > following:
            self._skip_to(camera, count)
            self._request_missing(camera, now)
        if before is None or _state(before) != _state(status):
            self.emit(CaptureStatusChanged(self.target, status))

    def _image(self, camera: CameraReports, image: CapturedImage, at: int, now: float) -> None:
        index = image.index
        if index >= 0 and not self._is_new(camera, index, at):
            return
        camera.newest_image_at = max(camera.newest_image_at, at)
        # an image with a negative index is always new: the camera does not number its images
        self.emit(ImageCaptured(self.target, image))
        self._request_missing(camera, now)

    def _is_new(self, camera: CameraReports, index: int, at: int) -> bool:
        """Record the index of an image; return False if the image was reported before."""
        following = camera.next_image
        if index in camera.missing:
            del camera.missing[index]
            camera.requested.discard(index)
        elif following is None or index >= following:
            if following is not None:
                self._skip_to(camera, index)
            camera.next_image = index + 1
        elif index == 0 and at > camera.newest_image_at:
            self._restart(camera, 1)  # the image log was reset
        else:
            return False
        return True

    def _restart(self, camera: CameraReports, following: int) -> None:
        camera.next_image = following
        camera.missing.clear()
        camera.requested.clear()

    def _skip_to(self, camera: CameraReports, index: int) -> None:
        first = camera.next_image or 0
        camera.missing.update(dict.fromkeys(range(max(first, index - MAX_MISSING), index)))
        for oldest in list(camera.missing)[: max(len(camera.missing) - MAX_MISSING, 0)]:
            del camera.missing[oldest]
        camera.next_image = index

    def _request_missing(self, camera: CameraReports, now: float) -> None:
        if self._begin is None:
            return
        for index in [each for each in camera.missing if each not in camera.requested]:
            if len(camera.requested) >= MAX_REQUESTS:
                return
            camera.requested.add(index)
            self._begin(_RequestImage(camera, index, self._request_ended), now)

    def _request_ended(self, camera: CameraReports, index: int, now: float) -> None:
        """Give up an image that the camera does not send again, and request the next missing one."""
        camera.missing.pop(index, None)
        camera.requested.discard(index)
        self._request_missing(camera, now)


class _RequestImage(RequestMessage):
    """The request of one missing image; the monitor reads the message when it arrives."""

    def __init__(
        self, camera: CameraReports, index: int, on_failure: Callable[[CameraReports, int, float], None]
    ) -> None:
        super().__init__(
            common.CameraImageCaptured,
            (float(index),),
            match=lambda message: message.image_index == index and message.camera_id == camera.device_id,
            timeout=REQUEST_TIMEOUT,
        )
        self._camera, self._of, self._on_failure = camera, index, on_failure

    def tick(self, now: float) -> None:
        super().tick(now)
        self._check_end(now)

    def child_ended(self, child: Operation[Any], now: float) -> None:
        super().child_ended(child, now)
        self._check_end(now)

    def _check_end(self, now: float) -> None:
        if self.done and self.error is not None:
            self._on_failure(self._camera, self._of, now)


def _state(status: CaptureStatus) -> tuple[object, ...]:
    return status.capturing, status.interval, status.recording, status.image_count
