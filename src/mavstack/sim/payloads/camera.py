"""A simulated camera: a component of its own on the vehicle's links.

Each image has the place of the vehicle and the attitude of the gimbal, if there is one, at the moment of the
capture. Images and recordings fill the storage; a full one refuses both. The settings are extended
parameters, described by a definition file that the camera serves over MAVLink FTP.
"""

from __future__ import annotations

import lzma
from dataclasses import replace
from math import degrees
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.camera import (
    CameraDevice,
    CameraInformation,
    CameraModeEntered,
    CameraServer,
    CameraSettingsServer,
    CapturedImage,
    ImageTaken,
    Storage,
    TrackedTarget,
    VideoStream,
)
from mavstack.services.command import CommandServer
from mavstack.services.extended_parameters import ExtendedParameterWritten
from mavstack.services.ftp import FtpServer, MemoryStore
from mavstack.services.gimbal import quaternion_of
from mavstack.services.heartbeat import HeartbeatSender
from mavstack.services.message_request import MessageServer
from mavstack.services.ping import PingServer
from mavstack.services.timesync import TimesyncServer
from mavstack.sim.payloads.definition import TEXT, VERSION, simulated_definition

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.services.camera import SettingValue
    from mavstack.sim.payloads.gimbal import SimulatedGimbal
    from mavstack.sim.vehicle import SimulatedVehicle

CAMERA_COMPONENT = int(common.MavComponent.CAMERA)
#: In MiB: capacity of the storage, size of an image (JPEG, raw), and of a second of video (3840 x 2160, 1920
#: x 1080).
CAPACITY = 4096.0
IMAGE_SIZES = {0: 8.0, 1: 40.0}
VIDEO_RATES = {0: 12.0, 1: 4.0}
_FILE = "camera.xml.xz"

_CAPS = common.CameraCapFlags
_CAPABILITIES = int(
    _CAPS.CAPTURE_IMAGE
    | _CAPS.CAPTURE_VIDEO
    | _CAPS.HAS_MODES
    | _CAPS.HAS_BASIC_ZOOM
    | _CAPS.HAS_BASIC_FOCUS
    | _CAPS.HAS_VIDEO_STREAM
    | _CAPS.HAS_TRACKING_POINT
    | _CAPS.HAS_TRACKING_RECTANGLE
)


class _Device(CameraDevice):
    """The hardware of the camera: its storage, its lens, its place."""

    def __init__(self, vehicle: SimulatedVehicle, gimbal: SimulatedGimbal | None) -> None:
        super().__init__(
            CameraInformation(
                "Mavstack",
                "Simulated camera",
                firmware_version=1,
                focal_length=24.0,
                sensor_width=13.2,
                sensor_height=8.8,
                width=5472,
                height=3648,
                capabilities=_CAPABILITIES,
                definition_uri=f"mftp://{_FILE}",
                definition_version=VERSION,
                gimbal_device_id=0 if gimbal is None else gimbal.information.device_id,
            ),
            streams=[VideoStream(1, 1, "rtsp://127.0.0.1:8554/camera", "camera", field_of_view=70)],
        )
        self._vehicle, self._gimbal = vehicle, gimbal
        self.stream_uri = ""
        self.zoom, self.focus = 0.0, 50.0
        self.used = 0.0
        self.settings: CameraSettingsServer | None = None
        self._target: TrackedTarget | None = None
        self._recorded_until: float | None = None

    @property
    def streams(self) -> Sequence[VideoStream]:
        streams = super().streams
        if not self.stream_uri:
            return streams
        return tuple(replace(each, uri=self.stream_uri) for each in streams)

    @property
    def storages(self) -> tuple[Storage, ...]:
        self._record(self._vehicle.now)
        used = min(self.used, CAPACITY)
        return (
            Storage(
                total=CAPACITY,
                used=used,
                available=CAPACITY - used,
                type=common.StorageType.MICROSD,
                name="simulated card",
                write_speed=80.0,
            ),
        )

    @property
    def tracked(self) -> TrackedTarget | None:
        return self._target

    def capture(self, index: int, now: float) -> CapturedImage:
        size = IMAGE_SIZES.get(int(self._setting("CAM_PHOTOFMT")), 8.0)
        stored = self.storages[0].available >= size
        self.used += size if stored else 0.0
        body = self._vehicle.body
        here = body.estimate
        latitude, longitude, altitude = body.frame.to_global(here.north, here.east, here.down)
        roll, pitch, yaw = (degrees(angle) for angle in (here.roll, here.pitch, here.yaw))
        attitude = None if self._gimbal is None else self._gimbal.advance(now, yaw)
        if attitude is not None:
            roll, pitch, yaw = attitude.roll, attitude.pitch, attitude.heading or 0.0
        return CapturedImage(
            index,
            stored,
            now,
            latitude,
            longitude,
            altitude,
            altitude - body.home.altitude,
            quaternion_of(roll, pitch, yaw),
        )

    def start_video(self, stream: int, now: float) -> bool:
        if self.storages[0].available <= 0:
            return False
        self._recorded_until = now
        return True

    def stop_video(self, stream: int, now: float) -> bool:
        self._record(now)
        self._recorded_until = None
        return True

    def format_storage(self, storage: int, now: float) -> bool:
        self.used = 0.0
        return True

    def reset_settings(self, now: float) -> bool:
        self.zoom, self.focus = 0.0, 50.0
        if self.settings is not None:
            self.settings.reset()
        return True

    def set_zoom(self, kind: int, value: float, now: float) -> bool:
        return kind in (common.CameraZoomType.CONTINUOUS, common.CameraZoomType.STEP) or self._set_range(
            "zoom", kind == common.CameraZoomType.RANGE, value
        )

    def set_focus(self, kind: int, value: float, now: float) -> bool:
        return kind != common.SetFocusType.RANGE or self._set_range("focus", True, value)

    def track(self, target: TrackedTarget | None, now: float) -> bool:
        self._target = target
        return True

    def _set_range(self, name: str, known: bool, value: float) -> bool:
        if known:
            setattr(self, name, value)
        return known

    def _record(self, now: float) -> None:
        """Add the recording since the last call to the storage."""
        if self._recorded_until is not None:
            rate = VIDEO_RATES.get(int(self._setting("CAM_VIDRES")), 4.0)
            self.used += rate * max(now - self._recorded_until, 0.0)
            self._recorded_until = now

    def _setting(self, name: str) -> SettingValue:
        value = 0 if self.settings is None else self.settings[name]
        return 0 if isinstance(value, bytes | str) else value


class SimulatedCamera:
    """The camera component of a simulated vehicle; `attach` runs it on the vehicle's links.

    Args:
        vehicle: The vehicle.
        gimbal: The gimbal that carries the camera; None: fixed to the vehicle.
    """

    def __init__(self, vehicle: SimulatedVehicle, gimbal: SimulatedGimbal | None = None) -> None:
        self._vehicle = vehicle
        self.address = address = Address(vehicle.address.system, CAMERA_COMPONENT)
        self.device = _Device(vehicle, gimbal)
        commands = CommandServer(address)
        messages = MessageServer(address, commands)
        messages.data_streams = {}
        self.server = CameraServer(address, self.device, booted_at=vehicle.now)
        self.server.answer(commands, messages)
        self.settings = self.device.settings = CameraSettingsServer(address, simulated_definition())
        files = MemoryStore({_FILE: lzma.compress(TEXT.encode())})
        self._services = (
            HeartbeatSender(address, common.MavType.CAMERA),
            commands,
            messages,
            self.server,
            self.settings,
            FtpServer(address, files),
            PingServer(address),
            TimesyncServer(address),
        )

    def attach(self) -> None:
        """Run the camera on the vehicle's engine, which is new at each boot of the autopilot."""
        vehicle = self._vehicle
        for service in self._services:
            vehicle.engine.add(service)
        vehicle.on_event(ImageTaken, lambda event: self._image_taken(event.image))
        vehicle.on_event(CameraModeEntered, lambda event: self._mode_entered(event.mode))
        vehicle.on_event(ExtendedParameterWritten, self._setting_written)

    @property
    def images(self) -> int:
        """The images since the storage was formatted."""
        return self.server.count()

    def capture(self) -> None:
        """Take an image now, as the autopilot triggers it."""
        self.server.capture(self._vehicle.now)
        self._vehicle.touch(self.server)

    def _image_taken(self, image: CapturedImage) -> None:
        place = f"{image.latitude:.6f}, {image.longitude:.6f}, {image.relative_altitude:.0f} m"
        text = f"image {image.index} at {place}" if image.success else "image failed: the storage is full"
        self._vehicle.announce("camera", text)

    def _mode_entered(self, mode: int) -> None:
        if mode in (0, 1):
            self.settings.set("CAM_MODE", mode)
            self._vehicle.touch(self.settings)

    def _setting_written(self, event: ExtendedParameterWritten) -> None:
        if event.parameter.name == "CAM_MODE" and isinstance(event.parameter.value, int):
            self.server.set_mode(event.parameter.value, self._vehicle.now)
            self._vehicle.touch(self.server)
