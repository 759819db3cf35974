"""The server of the camera protocol v2, for a camera component or for cameras attached to an autopilot.

    server = CameraServer(local, CameraDevice(CameraInformation("Maker", "Model")))
    server.answer(commands, messages)       the command server and the message server of the component

An attached camera has a device id from 1 to 6, and the autopilot answers for it; a camera component has the
device id 0 and also answers to its own component id (guide: camera addressing).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import Address, message_ids
from mavstack.services.camera.camera_commands import CameraCommands
from mavstack.services.camera.device import CameraDevice
from mavstack.services.camera.managed import ManagedCamera
from mavstack.services.camera.reports import MAX_ATTACHED_DEVICE, OWN_COMPONENT
from mavstack.services.service import Event, Service, earliest

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.dialects import Message
    from mavstack.services.camera.media import CapturedImage
    from mavstack.services.command import CommandServer
    from mavstack.services.message_request import MessageServer
    from mavstack.wire import Packet

#: Seconds between two CAMERA_TRACKING_IMAGE_STATUS while a target is tracked.
TRACKING_INTERVAL = 0.2


@dataclass(frozen=True, slots=True)
class ImageTaken(Event):
    """A camera of the server took an image."""

    image: CapturedImage


@dataclass(frozen=True, slots=True)
class CameraModeEntered(Event):
    """A camera of the server entered a CAMERA_MODE."""

    mode: int
    device_id: int


class CameraServer(Service):
    """The cameras of one component.

    Args:
        local: The component.
        devices: The camera, or the attached cameras with different device ids.
        booted_at: When the component started, Unix seconds, for `time_boot_ms`; None: with its first message.

    Raises:
        InvalidArgumentError: There is no camera, two have one device id, or an id is above 6.
    """

    #: The command server executes these commands. Their ids are listed here so that the messages and events
    #: of this service are sent afterwards.
    handles = message_ids(common.CommandLong, common.CommandInt)

    def __init__(
        self,
        local: Address,
        devices: CameraDevice | Sequence[CameraDevice],
        *,
        booted_at: float | None = None,
    ) -> None:
        super().__init__(local)
        devices = (devices,) if isinstance(devices, CameraDevice) else tuple(devices)
        self._booted_at = booted_at
        self._cameras = {
            device.information.device_id: ManagedCamera(device, self._image_taken) for device in devices
        }
        if (
            not devices
            or len(self._cameras) < len(devices)
            or max(self._cameras) > MAX_ATTACHED_DEVICE
            or (OWN_COMPONENT in self._cameras and len(devices) > 1)
        ):
            raise InvalidArgumentError("cameras need different device ids from 1 to 6, a single one also 0")

    def answer(self, commands: CommandServer, messages: MessageServer) -> None:
        """Answer the commands and requests of the protocol by the component's servers.

        Args:
            commands: The command server of the component.
            messages: The message server of the component.
        """
        CameraCommands(self).register(commands)
        messages.provide(common.CameraInformation, self._informations)
        messages.provide(common.CameraSettings, self._settings)
        messages.provide(common.CameraCaptureStatus, self._capture_statuses)
        messages.provide_instances(common.StorageInformation, self._storages)
        messages.provide_instances(common.VideoStreamInformation, self._streams)
        messages.provide_instances(common.VideoStreamStatus, self._stream_statuses)
        messages.provide_instances(common.CameraImageCaptured, self._logged)
        if any(camera.can_track for camera in self._cameras.values()):
            messages.provide(common.CameraTrackingImageStatus, self._tracked, interval=TRACKING_INTERVAL)

    # Methods for the program

    def capture(self, now: float, device_id: int = OWN_COMPONENT) -> None:
        """Take an image on behalf of the camera itself, such as by its button."""
        self._cameras[device_id].sequence.capture(now)

    def image_captured(self, image: CapturedImage, now: float) -> None:
        """Report an image that `CameraDevice.capture` did not return at once."""
        self._cameras[image.device_id].sequence.captured(image, now)

    def set_mode(self, mode: int, now: float, device_id: int = OWN_COMPONENT) -> None:
        """Enter a CAMERA_MODE on behalf of the camera itself, and report it."""
        self.enter_mode(self._cameras[device_id], mode, now)

    def mode(self, device_id: int = OWN_COMPONENT) -> int:
        """Return the present CAMERA_MODE."""
        return self._cameras[device_id].sequence.mode

    def count(self, device_id: int = OWN_COMPONENT) -> int:
        """Return the number of images since the image log was reset."""
        return self._cameras[device_id].sequence.count

    # Methods of a service

    def receive(self, packet: Packet, now: float) -> None:
        """Do nothing: the command server answers."""

    def next_timeout(self) -> float | None:
        return earliest(*(camera.next_timeout() for camera in self._cameras.values()))

    def handle_timeout(self, now: float) -> None:
        for camera in self._cameras.values():
            camera.sequence.advance(now)
            if camera.status_is_due(now):
                self.send(camera.sequence.status(now).to_message(self.milliseconds(now)))

    # Methods for `CameraCommands`

    def selected(self, device_id: float) -> list[ManagedCamera]:
        """Return the cameras that a device id stands for; 0 for all."""
        if device_id == OWN_COMPONENT or (
            OWN_COMPONENT in self._cameras and device_id == self.local.component
        ):
            return list(self._cameras.values())
        return [camera for number, camera in self._cameras.items() if number == device_id]

    def enter_mode(self, camera: ManagedCamera, mode: int, now: float) -> None:
        """Enter a mode that the device accepted."""
        changed, camera.sequence.mode = camera.sequence.mode != mode, mode
        if changed:
            self.emit(CameraModeEntered(mode, camera.device_id))
        self.report_settings(camera, now)

    def report_settings(self, camera: ManagedCamera, now: float) -> None:
        """Broadcast CAMERA_SETTINGS."""
        self.send(camera.device.status(camera.sequence.mode).to_message(self.milliseconds(now)))

    def report_capture(self, camera: ManagedCamera, now: float) -> None:
        """Broadcast CAMERA_CAPTURE_STATUS."""
        self.send(camera.sequence.status(now).to_message(self.milliseconds(now)))

    def report_storages(self, camera: ManagedCamera, now: float) -> None:
        """Broadcast STORAGE_INFORMATION."""
        for storage in camera.device.storages:
            self.send(storage.to_message(self.milliseconds(now)))

    def milliseconds(self, now: float) -> int:
        """Return `time_boot_ms`."""
        if self._booted_at is None:
            self._booted_at = now
        return max(round((now - self._booted_at) * 1e3), 0) & 0xFFFFFFFF

    def _image_taken(self, image: CapturedImage, now: float) -> None:
        self.send(image.to_message(self.milliseconds(now)))
        self.emit(ImageTaken(image))

    # Messages

    def _informations(self, now: float) -> list[Message]:
        milliseconds = self.milliseconds(now)
        return [camera.device.information.to_message(milliseconds) for camera in self._cameras.values()]

    def _settings(self, now: float) -> list[Message]:
        milliseconds = self.milliseconds(now)
        return [
            camera.device.status(camera.sequence.mode).to_message(milliseconds)
            for camera in self._cameras.values()
        ]

    def _capture_statuses(self, now: float) -> list[Message]:
        milliseconds = self.milliseconds(now)
        return [camera.sequence.status(now).to_message(milliseconds) for camera in self._cameras.values()]

    def _storages(self, which: float, now: float) -> list[Message]:
        milliseconds = self.milliseconds(now)
        return [
            storage.to_message(milliseconds)
            for camera in self._cameras.values()
            for storage in camera.device.storages
            if which in (0, storage.id)
        ]

    def _streams(self, which: float, now: float) -> list[Message]:
        return [
            stream.to_message()
            for camera in self._cameras.values()
            for stream in camera.streams()
            if which in (0, stream.id)
        ]

    def _stream_statuses(self, which: float, now: float) -> list[Message]:
        return [
            stream.to_status()
            for camera in self._cameras.values()
            for stream in camera.streams()
            if which in (0, stream.id)
        ]

    def _logged(self, index: float, now: float) -> list[Message]:
        """Return CAMERA_IMAGE_CAPTURED of an index, as it was sent."""
        found = [camera.sequence.log.get(int(index)) for camera in self._cameras.values() if index >= 0]
        return [image.to_message(self.milliseconds(at)) for each in found if each for image, at in (each,)]

    def _tracked(self, now: float) -> list[Message]:
        targets = (camera.device.tracked for camera in self._cameras.values())
        return [target.to_message() for target in targets if target is not None]
