"""The reports of a camera: identity, settings, capture status, storages, video streams, images, tracking.

A camera is a MAVLink component, or with a device id from 1 to 6 a part of the autopilot (guide: camera
protocol v2). Each class reads one message and writes it; unknown values are None.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isnan, nan
from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from typing import Self

#: The device id of a camera that is a component itself.
OWN_COMPONENT = 0
#: The largest device id of a camera that is attached to an autopilot.
MAX_ATTACHED_DEVICE = 6

_CAPS = common.CameraCapFlags
#: The camera has modes for images and video, basic zoom and basic focus.
DEFAULT_CAPABILITIES = (
    _CAPS.CAPTURE_IMAGE | _CAPS.CAPTURE_VIDEO | _CAPS.HAS_MODES | _CAPS.HAS_BASIC_ZOOM | _CAPS.HAS_BASIC_FOCUS
)


@dataclass(frozen=True, slots=True)
class CameraInformation:
    """The identity and abilities of a camera (CAMERA_INFORMATION).

    Attributes:
        vendor: The maker.
        model: The model.
        firmware_version: Four bytes: development (highest), patch, minor, major; 0 if unknown.
        focal_length: Millimetres; None if unknown.
        sensor_width: Millimetres; None if unknown.
        sensor_height: Millimetres; None if unknown.
        width: Pixels; 0 if unknown.
        height: Pixels; 0 if unknown.
        lens_id: The number of the lens.
        capabilities: CAMERA_CAP_FLAGS.
        definition_uri: The place of the camera definition file: mftp:// or http://; "" if there is none.
        definition_version: The version of that file.
        gimbal_device_id: The gimbal that carries the camera; 0 if there is none.
        device_id: 1 to 6 for a camera attached to the autopilot; 0 for one with a component of its own.
    """

    vendor: str = ""
    model: str = ""
    firmware_version: int = 0
    focal_length: float | None = None
    sensor_width: float | None = None
    sensor_height: float | None = None
    width: int = 0
    height: int = 0
    lens_id: int = 0
    capabilities: int = DEFAULT_CAPABILITIES
    definition_uri: str = ""
    definition_version: int = 0
    gimbal_device_id: int = 0
    device_id: int = OWN_COMPONENT

    def can(self, capability: int) -> bool:
        """Return whether the camera has all of these CAMERA_CAP_FLAGS."""
        return self.capabilities & capability == capability

    @property
    def firmware(self) -> str:
        """The firmware version as text, such as "1.4.2"; "" if unknown."""
        version = self.firmware_version
        numbers = [version >> shift & 0xFF for shift in (0, 8, 16, 24)]
        return ".".join(map(str, numbers if numbers[3] else numbers[:3])) if version else ""

    @classmethod
    def read(cls, message: common.CameraInformation) -> Self:
        """Return the content of a message."""
        return cls(
            _text(message.vendor_name),
            _text(message.model_name),
            message.firmware_version,
            _known(message.focal_length),
            _known(message.sensor_size_h),
            _known(message.sensor_size_v),
            message.resolution_h,
            message.resolution_v,
            message.lens_id,
            int(message.flags),
            message.cam_definition_uri,
            message.cam_definition_version,
            message.gimbal_device_id,
            message.camera_device_id,
        )

    def to_message(self, milliseconds: int) -> common.CameraInformation:
        """Return the message at a time since boot."""
        return common.CameraInformation(
            time_boot_ms=milliseconds,
            vendor_name=_bytes(self.vendor),
            model_name=_bytes(self.model),
            firmware_version=self.firmware_version,
            focal_length=_or_nan(self.focal_length),
            sensor_size_h=_or_nan(self.sensor_width),
            sensor_size_v=_or_nan(self.sensor_height),
            resolution_h=self.width,
            resolution_v=self.height,
            lens_id=self.lens_id,
            flags=self.capabilities,
            cam_definition_uri=self.definition_uri,
            cam_definition_version=self.definition_version,
            gimbal_device_id=self.gimbal_device_id,
            camera_device_id=self.device_id,
        )


@dataclass(frozen=True, slots=True)
class CameraStatus:
    """The mode, zoom and focus of a camera (CAMERA_SETTINGS).

    Attributes:
        mode: A CAMERA_MODE.
        zoom: Percent of the zoom range; None if unknown.
        focus: Percent of the focus range; None if unknown.
        device_id: The attached camera; 0 for a component of its own.
    """

    mode: int = common.CameraMode.IMAGE
    zoom: float | None = None
    focus: float | None = None
    device_id: int = OWN_COMPONENT

    @classmethod
    def read(cls, message: common.CameraSettings) -> Self:
        """Return the content of a message."""
        return cls(
            int(message.mode_id),
            _known(message.zoomLevel),
            _known(message.focusLevel),
            message.camera_device_id,
        )

    def to_message(self, milliseconds: int) -> common.CameraSettings:
        """Return the message at a time since boot."""
        return common.CameraSettings(
            time_boot_ms=milliseconds,
            mode_id=self.mode,
            zoomLevel=_or_nan(self.zoom),
            focusLevel=_or_nan(self.focus),
            camera_device_id=self.device_id,
        )


@dataclass(frozen=True, slots=True)
class CaptureStatus:
    """The present captures of a camera (CAMERA_CAPTURE_STATUS).

    Attributes:
        capturing: True while an image is captured.
        interval: Seconds between two images; None if no series of images runs.
        recording: True while video is recorded.
        recording_time: Seconds since the recording began; 0 if unknown.
        available: Free storage in MiB.
        image_count: Images captured since the image log was reset.
        device_id: The attached camera; 0 for a component of its own.
    """

    capturing: bool = False
    interval: float | None = None
    recording: bool = False
    recording_time: float = 0.0
    available: float = 0.0
    image_count: int = 0
    device_id: int = OWN_COMPONENT

    @classmethod
    def read(cls, message: common.CameraCaptureStatus) -> Self:
        """Return the content of a message."""
        return cls(
            bool(message.image_status & 1),
            message.image_interval if message.image_status & 2 else None,
            message.video_status == 1,
            message.recording_time_ms / 1e3,
            message.available_capacity,
            message.image_count,
            message.camera_device_id,
        )

    def to_message(self, milliseconds: int) -> common.CameraCaptureStatus:
        """Return the message at a time since boot."""
        return common.CameraCaptureStatus(
            time_boot_ms=milliseconds,
            image_status=int(self.capturing) | (0 if self.interval is None else 2),
            video_status=int(self.recording),
            image_interval=self.interval or 0.0,
            recording_time_ms=min(round(self.recording_time * 1e3), 0xFFFFFFFF),
            available_capacity=self.available,
            image_count=self.image_count,
            camera_device_id=self.device_id,
        )


@dataclass(frozen=True, slots=True)
class Storage:
    """One storage medium of a camera (STORAGE_INFORMATION).

    Attributes:
        id: Its number, from 1.
        count: The number of storages.
        status: A STORAGE_STATUS.
        total: Capacity in MiB.
        used: MiB in use.
        available: Free MiB.
        type: A STORAGE_TYPE.
        name: The name; "" if it has none.
        usage: STORAGE_USAGE_FLAG.
        read_speed: MiB per second.
        write_speed: MiB per second.
    """

    id: int = 1
    count: int = 1
    status: int = common.StorageStatus.READY
    total: float = 0.0
    used: float = 0.0
    available: float = 0.0
    type: int = common.StorageType.UNKNOWN
    name: str = ""
    usage: int = 0
    read_speed: float = 0.0
    write_speed: float = 0.0

    @classmethod
    def read(cls, message: common.StorageInformation) -> Self:
        """Return the content of a message."""
        return cls(
            message.storage_id,
            message.storage_count,
            int(message.status),
            message.total_capacity,
            message.used_capacity,
            message.available_capacity,
            int(message.type),
            message.name,
            int(message.storage_usage),
            message.read_speed,
            message.write_speed,
        )

    def to_message(self, milliseconds: int) -> common.StorageInformation:
        """Return the message at a time since boot."""
        return common.StorageInformation(
            time_boot_ms=milliseconds,
            storage_id=self.id,
            storage_count=self.count,
            status=self.status,
            total_capacity=self.total,
            used_capacity=self.used,
            available_capacity=self.available,
            read_speed=self.read_speed,
            write_speed=self.write_speed,
            type=self.type,
            name=self.name,
            storage_usage=self.usage,
        )


def _text(field: str | bytes) -> str:
    if isinstance(field, bytes):
        return field.partition(b"\0")[0].decode("utf-8", "replace")
    return field


def _bytes(text: str, size: int = 32) -> bytes:
    """Encode a text for a byte field, without cutting a character in two."""
    return text.encode()[:size].decode("utf-8", "ignore").encode().ljust(size, b"\0")


def _known(value: float) -> float | None:
    return None if isnan(value) else value


def _or_nan(value: float | None) -> float:
    return nan if value is None else value
