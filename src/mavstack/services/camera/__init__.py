"""The camera protocol v2: images, video, streams, storages, settings, tracking; client and server."""

from mavstack.services.camera.definition import (
    CameraDefinition,
    CameraSetting,
    OptionRange,
    SettingOption,
    SettingValue,
)
from mavstack.services.camera.definition_file import read_definition
from mavstack.services.camera.device import CameraDevice
from mavstack.services.camera.media import CapturedImage, TrackedTarget, VideoStream
from mavstack.services.camera.monitor import (
    CameraFound,
    CameraMonitor,
    CameraReports,
    CaptureStatusChanged,
    ImageCaptured,
)
from mavstack.services.camera.operations import (
    ListCameras,
    ListStorages,
    ListStreams,
    RequestReport,
    SetCameraMode,
    TakePhoto,
    mode_name,
)
from mavstack.services.camera.reports import CameraInformation, CameraStatus, CaptureStatus, Storage
from mavstack.services.camera.server import CameraModeEntered, CameraServer, ImageTaken
from mavstack.services.camera.settings_server import CameraSettingsServer

__all__ = [
    "CameraDefinition",
    "CameraDevice",
    "CameraFound",
    "CameraInformation",
    "CameraModeEntered",
    "CameraMonitor",
    "CameraReports",
    "CameraServer",
    "CameraSetting",
    "CameraSettingsServer",
    "CameraStatus",
    "CaptureStatus",
    "CaptureStatusChanged",
    "CapturedImage",
    "ImageCaptured",
    "ImageTaken",
    "ListCameras",
    "ListStorages",
    "ListStreams",
    "OptionRange",
    "RequestReport",
    "SetCameraMode",
    "SettingOption",
    "SettingValue",
    "Storage",
    "TakePhoto",
    "TrackedTarget",
    "VideoStream",
    "mode_name",
    "read_definition",
]
