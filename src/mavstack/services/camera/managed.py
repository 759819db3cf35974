"""One camera of a `CameraServer`: its device, its captures, and the streams that run."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.camera.sequence import CaptureSequence
from mavstack.services.service import earliest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.services.addressing import Address
    from mavstack.services.camera.device import CameraDevice
    from mavstack.services.camera.media import CapturedImage, VideoStream

#: Seconds in which a single-image request with the same number is a repetition; later the client may count
#: from 1 again.
REPETITION_WINDOW = 5.0

_CAPS = common.CameraCapFlags


class ManagedCamera:
    """One camera of a server."""

    def __init__(self, device: CameraDevice, on_image: Callable[[CapturedImage, float], None]) -> None:
        self.device = device
        self.sequence = CaptureSequence(device, on_image)
        #: The sender, number and time of the last single-image request, so that a repetition takes no second
        #: image.
        self._last_request: tuple[Address, float, float] | None = None
        self._running = {stream.id: stream.running for stream in device.streams}
        self._status_interval: float | None = None
        self._status_due: float | None = None

    @property
    def device_id(self) -> int:
        """The device id; 0 for a camera component."""
        return self.device.information.device_id

    @property
    def can_track(self) -> bool:
        """True if the camera tracks points or rectangles."""
        return bool(
            self.device.information.capabilities & (_CAPS.HAS_TRACKING_POINT | _CAPS.HAS_TRACKING_RECTANGLE)
        )

    def repeats(self, source: Address, number: float, now: float) -> bool:
        """Return whether a request for a single image was received before; numbers count from 1."""
        last, self._last_request = self._last_request, (source, number, now)
        if last is None or number < 1 or now - last[2] > REPETITION_WINDOW:
            return False
        return last[:2] == (source, number)

    def streams(self) -> Iterator[VideoStream]:
        """Yield the streams as they run now."""
        for stream in self.device.streams:
            yield replace(
                stream, running=self._running.get(stream.id, stream.running), device_id=self.device_id
            )

    def set_running(self, stream: int, running: bool) -> None:
        """Record that a stream began or ended; 0 for all."""
        for number in self._running:
            if stream in (0, number):
                self._running[number] = running

    def has_stream(self, stream: float) -> bool:
        """Return whether a number stands for a stream, or for all."""
        return stream == 0 or stream in self._running

    def stream_status(self, rate: float, now: float) -> None:
        """Send CAMERA_CAPTURE_STATUS at a rate in hertz from now on; 0: no longer."""
        self._status_interval = 1.0 / rate if rate > 0 else None
        self._status_due = now if rate > 0 else None

    def status_is_due(self, now: float) -> bool:
        """Return whether CAMERA_CAPTURE_STATUS is due, and schedule the next one."""
        if self._status_due is None or self._status_interval is None or now < self._status_due:
            return False
        following = self._status_due + self._status_interval
        self._status_due = following if following > now else now + self._status_interval
        return True

    def next_timeout(self) -> float | None:
        """Return when the next image or the next status is due."""
        return earliest(self.sequence.next_due, self._status_due)
