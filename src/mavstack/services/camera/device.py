"""A camera as the server drives it: a class to derive from.

    class Camera(CameraDevice):
        def capture(self, index, now):
            path = take_picture()
            return CapturedImage(index, time=now, url=path)

The methods do what the hardware can; the server keeps the protocol: modes, series of images, the image log,
reports. A method that returns False refuses its command. Commands for abilities that
`information.capabilities` does not name are answered UNSUPPORTED and reach no method.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services.camera.media import CapturedImage
from mavstack.services.camera.reports import CameraInformation, CameraStatus

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.services.camera.media import TrackedTarget, VideoStream
    from mavstack.services.camera.reports import Storage


class CameraDevice:
    """One camera; override what the hardware can do.

    Args:
        information: The identity and abilities.
        storages: The storages at the start; override `storages` if they change.
        streams: The video streams at the start.
    """

    def __init__(
        self,
        information: CameraInformation | None = None,
        *,
        storages: Sequence[Storage] = (),
        streams: Sequence[VideoStream] = (),
    ) -> None:
        self.information = information or CameraInformation()
        #: The present zoom and focus, percent; None if unknown.
        self.zoom: float | None = None
        self.focus: float | None = None
        self._storages, self._streams = tuple(storages), tuple(streams)

    @property
    def storages(self) -> Sequence[Storage]:
        """The storages now."""
        return self._storages

    @property
    def streams(self) -> Sequence[VideoStream]:
        """The video streams; the server knows which of them run."""
        return self._streams

    @property
    def tracked(self) -> TrackedTarget | None:
        """The target that the camera tracks now; None if it tracks none."""
        return None

    def status(self, mode: int) -> CameraStatus:
        """Return the reported settings in a mode."""
        return CameraStatus(mode, self.zoom, self.focus, self.information.device_id)

    def capture(self, index: int, now: float) -> CapturedImage | None:
        """Take an image.

        Args:
            index: The number of the image.
            now: Unix seconds.

        Returns:
            The image, or None if it takes time: then call `CameraServer.image_captured` when it is there.
        """
        return CapturedImage(index, time=now, device_id=self.information.device_id)

    def set_mode(self, mode: int, now: float) -> bool:
        """Enter a CAMERA_MODE."""
        return True

    def start_video(self, stream: int, now: float) -> bool:
        """Begin a recording of a stream; 0 for all."""
        return True

    def stop_video(self, stream: int, now: float) -> bool:
        """End the recording."""
        return True

    def set_streaming(self, stream: int, running: bool, now: float) -> bool:
        """Begin or end to send a video stream; 0 for all."""
        return True

    def set_zoom(self, kind: int, value: float, now: float) -> bool:
        """Zoom: `kind` is a CAMERA_ZOOM_TYPE, which says what the value means."""
        self.zoom = value
        return True

    def set_focus(self, kind: int, value: float, now: float) -> bool:
        """Focus: `kind` is a SET_FOCUS_TYPE, which says what the value means."""
        self.focus = value
        return True

    def format_storage(self, storage: int, now: float) -> bool:
        """Erase a storage; 0 for all."""
        return False

    def reset_settings(self, now: float) -> bool:
        """Reset the settings of the camera."""
        return False

    def track(self, target: TrackedTarget | None, now: float) -> bool:
        """Track a point or a rectangle of the image; None ends the tracking."""
        return False
