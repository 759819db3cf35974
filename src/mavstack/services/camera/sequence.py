"""The captures of one camera: single images, series of images, recordings, and the image log.

    idle ── start(interval, count) ── image ── interval ── image … count reached, or stop ──► idle
    idle ── start_video ── recording ── stop_video ──► idle

The images of a series lie on a grid from its start, so that the interval does not drift; images that were
missed during a stall are not made up for. The image log keeps the newest images, so that a client that missed
a message can request it again.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import replace
from math import floor
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.camera.reports import CaptureStatus

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.camera.device import CameraDevice
    from mavstack.services.camera.media import CapturedImage

MAX_LOG = 4096
#: The shortest interval between two images of a series, in seconds.
MIN_INTERVAL = 0.05

_CAPS, _MODE = common.CameraCapFlags, common.CameraMode


class CaptureSequence:
    """The state of the captures of one camera; `on_image` is called with each image and its time."""

    def __init__(self, device: CameraDevice, on_image: Callable[[CapturedImage, float], None]) -> None:
        self._device, self._on_image = device, on_image
        self.mode: int = _MODE.IMAGE
        self.count = 0
        self.log: OrderedDict[int, tuple[CapturedImage, float]] = OrderedDict()
        self.recording_since: float | None = None
        self._interval: float | None = None
        self._began = 0.0
        self._ticks = 0
        self._left: int | None = 0
        self._in_progress: set[int] = set()

    @property
    def next_due(self) -> float | None:
        """When the next image of the series is due; None without a series."""
        return None if self._interval is None else self._began + self._ticks * self._interval

    @property
    def may_capture(self) -> bool:
        """True if the camera takes images in its present mode."""
        can = self._device.information.can
        wrong = self.mode == _MODE.VIDEO and not can(_CAPS.CAN_CAPTURE_IMAGE_IN_VIDEO_MODE)
        return not (wrong and can(_CAPS.HAS_MODES))

    @property
    def may_record(self) -> bool:
        """True if the camera records in its present mode."""
        can = self._device.information.can
        wrong = self.mode != _MODE.VIDEO and not can(_CAPS.CAN_CAPTURE_VIDEO_IN_IMAGE_MODE)
        return not (wrong and can(_CAPS.HAS_MODES))

    def start(self, interval: float, count: int, now: float) -> None:
        """Take one image now, or a series of `count` images; a count of 0 runs until it is stopped."""
        if count == 1:
            self.capture(now)
            return
        self._interval, self._began, self._ticks = max(interval, MIN_INTERVAL), now, 0
        self._left = count or None
        self.advance(now)

    def stop(self) -> None:
        """End the series."""
        self._interval = None

    def advance(self, now: float) -> None:
        """Take the image of the series that is due."""
        due = self.next_due
        if due is None or now < due or self._interval is None:
            return
        self._ticks = max(self._ticks, floor((now - self._began) / self._interval + 1e-9)) + 1
        self.capture(now)
        if self._left is not None:
            self._left -= 1
            if self._left <= 0:
                self.stop()

    def capture(self, now: float) -> None:
        """Take one image."""
        index, self.count = self.count, self.count + 1
        self._in_progress.add(index)
        image = self._device.capture(index, now)
        if image is not None:
            self.captured(image, now)

    def captured(self, image: CapturedImage, now: float) -> None:
        """Log and report an image."""
        self._in_progress.discard(image.index)
        image = replace(image, device_id=self._device.information.device_id)
        self.log[image.index] = (image, now)
        if len(self.log) > MAX_LOG:
            self.log.popitem(last=False)
        self._on_image(image, now)

    def reset_log(self) -> None:
        """Forget all images, and count from 0 again."""
        self.count = 0
        self.log.clear()
        self._in_progress.clear()

    def status(self, now: float) -> CaptureStatus:
        """Return the capture status."""
        since = self.recording_since
        return CaptureStatus(
            bool(self._in_progress),
            self._interval,
            since is not None,
            0.0 if since is None else max(now - since, 0.001),
            sum(storage.available for storage in self._device.storages),
            self.count,
            self._device.information.device_id,
        )
