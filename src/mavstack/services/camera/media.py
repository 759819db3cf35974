"""Images, video streams and tracked targets of a camera."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite, nan
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.camera.reports import OWN_COMPONENT

if TYPE_CHECKING:
    from typing import Self

_STREAM, _TRACKING = common.VideoStreamStatusFlags, common.CameraTrackingMode
_IDENTITY = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class CapturedImage:
    """One image (CAMERA_IMAGE_CAPTURED), with the place and attitude for geotagging.

    Attributes:
        index: The number of the image, from 0, since the image log was reset.
        success: True if the image was captured.
        time: When it was taken, Unix seconds; None if unknown.
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above mean sea level.
        relative_altitude: Metres above ground.
        attitude: The camera's orientation, a quaternion (w, x, y, z).
        url: The place of the image: http:// or mftp://, or a path on the camera; "" if unknown.
        device_id: The attached camera; 0 for a component of its own.
    """

    index: int
    success: bool = True
    time: float | None = None
    latitude: float = 0.0
    longitude: float = 0.0
    altitude: float = 0.0
    relative_altitude: float = 0.0
    attitude: tuple[float, float, float, float] = _IDENTITY
    url: str = ""
    device_id: int = OWN_COMPONENT

    @classmethod
    def read(cls, message: common.CameraImageCaptured) -> Self:
        """Return the content of a message."""
        w, x, y, z = message.q
        return cls(
            message.image_index,
            message.capture_result == 1,
            message.time_utc / 1e6 if message.time_utc else None,
            message.lat / 1e7,
            message.lon / 1e7,
            message.alt / 1e3,
            message.relative_alt / 1e3,
            (w, x, y, z),
            message.file_url,
            message.camera_id,
        )

    def to_message(self, milliseconds: int) -> common.CameraImageCaptured:
        """Return the message at a time since boot."""
        return common.CameraImageCaptured(
            time_boot_ms=milliseconds,
            time_utc=0 if self.time is None else round(self.time * 1e6),
            camera_id=self.device_id,
            lat=round(self.latitude * 1e7),
            lon=round(self.longitude * 1e7),
            alt=round(self.altitude * 1e3),
            relative_alt=round(self.relative_altitude * 1e3),
            q=self.attitude,
            image_index=self.index,
            capture_result=int(self.success),
            file_url=self.url,
        )


@dataclass(frozen=True, slots=True)
class VideoStream:
    """One video stream of a camera (VIDEO_STREAM_INFORMATION and VIDEO_STREAM_STATUS).

    Attributes:
        id: Its number, from 1.
        count: The number of streams.
        uri: The address to open, such as rtsp://192.168.1.10:554/live.
        name: The name for people.
        type: A VIDEO_STREAM_TYPE.
        encoding: A VIDEO_STREAM_ENCODING.
        running: True while the camera sends the stream.
        thermal: True if the stream is a thermal image.
        frame_rate: Hertz.
        width: Pixels.
        height: Pixels.
        bit_rate: Bits per second.
        rotation: Degrees clockwise.
        field_of_view: Horizontal, degrees.
        device_id: The attached camera; 0 for a component of its own.
    """

    id: int = 1
    count: int = 1
    uri: str = ""
    name: str = ""
    type: int = common.VideoStreamType.RTSP
    encoding: int = common.VideoStreamEncoding.UNKNOWN
    running: bool = True
    thermal: bool = False
    frame_rate: float = 30.0
    width: int = 1920
    height: int = 1080
    bit_rate: int = 0
    rotation: int = 0
    field_of_view: int = 0
    device_id: int = OWN_COMPONENT

    @classmethod
    def read(cls, message: common.VideoStreamInformation) -> Self:
        """Return the content of a message."""
        stream = cls(
            message.stream_id,
            message.count,
            message.uri,
            message.name,
            int(message.type),
            int(message.encoding),
            device_id=message.camera_device_id,
        )
        return stream._with(message)

    def updated(self, message: common.VideoStreamStatus) -> Self:
        """Return the stream after a VIDEO_STREAM_STATUS."""
        return self._with(message)

    def to_message(self) -> common.VideoStreamInformation:
        """Return VIDEO_STREAM_INFORMATION."""
        return common.VideoStreamInformation(
            stream_id=self.id,
            count=self.count,
            type=self.type,
            flags=self._flags,
            framerate=self.frame_rate,
            resolution_h=self.width,
            resolution_v=self.height,
            bitrate=self.bit_rate,
            rotation=self.rotation,
            hfov=self.field_of_view,
            name=self.name,
            uri=self.uri,
            encoding=self.encoding,
            camera_device_id=self.device_id,
        )

    def to_status(self) -> common.VideoStreamStatus:
        """Return VIDEO_STREAM_STATUS."""
        return common.VideoStreamStatus(
            stream_id=self.id,
            flags=self._flags,
            framerate=self.frame_rate,
            resolution_h=self.width,
            resolution_v=self.height,
            bitrate=self.bit_rate,
            rotation=self.rotation,
            hfov=self.field_of_view,
            camera_device_id=self.device_id,
        )

    @property
    def _flags(self) -> int:
        return (int(_STREAM.RUNNING) if self.running else 0) | (int(_STREAM.THERMAL) if self.thermal else 0)

    def _with(self, message: common.VideoStreamInformation | common.VideoStreamStatus) -> Self:
        return replace(
            self,
            running=bool(message.flags & _STREAM.RUNNING),
            thermal=bool(message.flags & _STREAM.THERMAL),
            frame_rate=message.framerate,
            width=message.resolution_h,
            height=message.resolution_v,
            bit_rate=message.bitrate,
            rotation=message.rotation,
            field_of_view=message.hfov,
        )


@dataclass(frozen=True, slots=True)
class TrackedTarget:
    """The target that a camera tracks in its image (CAMERA_TRACKING_IMAGE_STATUS).

    Coordinates are shares of the image, from 0 at the left and top to 1 at the right and bottom.

    Attributes:
        status: CAMERA_TRACKING_STATUS_FLAGS.
        point: The x and y of the point; None if no point is tracked.
        radius: The radius of the point; None if unknown.
        rectangle: Left, top, right and bottom; None if no rectangle is tracked.
        device_id: The attached camera; 0 for a component of its own.
    """

    status: int = common.CameraTrackingStatusFlags.IDLE
    point: tuple[float, float] | None = None
    radius: float | None = None
    rectangle: tuple[float, float, float, float] | None = None
    device_id: int = OWN_COMPONENT

    @property
    def active(self) -> bool:
        """True while the camera tracks a target."""
        return bool(self.status & common.CameraTrackingStatusFlags.ACTIVE)

    @classmethod
    def read(cls, message: common.CameraTrackingImageStatus) -> Self:
        """Return the content of a message."""
        point = (message.point_x, message.point_y)
        corners = (message.rec_top_x, message.rec_top_y, message.rec_bottom_x, message.rec_bottom_y)
        by_point = message.tracking_mode == _TRACKING.POINT and all(map(isfinite, point))
        by_rectangle = message.tracking_mode == _TRACKING.RECTANGLE and all(map(isfinite, corners))
        return cls(
            int(message.tracking_status),
            point if by_point else None,
            message.radius if by_point and isfinite(message.radius) else None,
            corners if by_rectangle else None,
            message.camera_device_id,
        )

    def to_message(self) -> common.CameraTrackingImageStatus:
        """Return the message."""
        x, y = self.point or (nan, nan)
        left, top, right, bottom = self.rectangle or (nan, nan, nan, nan)
        mode = _TRACKING.POINT if self.point else _TRACKING.RECTANGLE if self.rectangle else _TRACKING.NONE
        return common.CameraTrackingImageStatus(
            tracking_status=self.status,
            tracking_mode=mode,
            target_data=common.CameraTrackingTargetData.IN_STATUS if self.active else 0,
            point_x=x,
            point_y=y,
            radius=nan if self.radius is None else self.radius,
            rec_top_x=left,
            rec_top_y=top,
            rec_bottom_x=right,
            rec_bottom_y=bottom,
            camera_device_id=self.device_id,
        )
