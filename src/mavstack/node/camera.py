"""A camera of a remote component: `component.camera`, `vehicle.camera()`."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.node.camera_actions import CameraActions
from mavstack.node.camera_settings import CameraSettings
from mavstack.node.read_only import ReadOnly
from mavstack.node.subscription import DEFAULT_QUEUE
from mavstack.services.camera import (
    CameraInformation,
    CameraStatus,
    CaptureStatus,
    ImageCaptured,
    ListStorages,
    ListStreams,
    RequestReport,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.node.clients import ComponentClients
    from mavstack.node.subscription import Subscription
    from mavstack.services import Address
    from mavstack.services.camera import Storage, TrackedTarget, VideoStream


class Camera(CameraActions, ReadOnly):
    """A camera: a component of its own, or one that is attached to the autopilot (camera protocol v2)."""

    _constructed = frozenset({"device_id"})

    def __init__(self, clients: ComponentClients, device_id: int = 0) -> None:
        self._clients = clients
        #: 1 to 6 for a camera that is attached to the autopilot; 0 for one with a component of its own.
        self.device_id = device_id
        self._monitor = clients.cameras

    @property
    def address(self) -> Address:
        """The component of the camera: its system and component id."""
        return self._clients.address

    # Reports that were received

    @property
    def information(self) -> CameraInformation | None:
        """The identity and abilities; None until received (`get_information` requests them)."""
        return self._monitor.reports(self.device_id).information

    @property
    def status(self) -> CameraStatus | None:
        """The last mode, zoom and focus that the camera reported; None until received."""
        return self._monitor.reports(self.device_id).status

    @property
    def capture_status(self) -> CaptureStatus | None:
        """The last report on series of images and recordings; None until received."""
        return self._monitor.reports(self.device_id).capture

    @property
    def tracked(self) -> TrackedTarget | None:
        """The last report on the tracked target; None until received."""
        return self._monitor.reports(self.device_id).tracked

    @property
    def streams(self) -> Mapping[int, VideoStream]:
        """The video streams received so far, by number."""
        return dict(self._monitor.reports(self.device_id).streams)

    @property
    def storages(self) -> Mapping[int, Storage]:
        """The storages received so far, by number."""
        return dict(self._monitor.storages)

    def images(self) -> Subscription[ImageCaptured]:
        """Subscribe to the images that the component's cameras capture, for any reason.

        A lost message is requested again, so that each image arrives once, if the camera keeps a log.

        Returns:
            An async iterator over events with an `image`; close it, or use it as an async context manager.
        """
        return self._clients.host.events(ImageCaptured, of=self._monitor, queue=DEFAULT_QUEUE)

    # Requests

    async def get_information(self, *, timeout: float | None = None) -> CameraInformation:
        """Request the identity and abilities (CAMERA_INFORMATION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The information.

        Raises:
            CommandDenied: The component has no camera.
            MessageTimeout: The component does not answer.
        """
        operation = RequestReport(common.CameraInformation, self.device_id, timeout=timeout)
        return CameraInformation.read(await self._run(operation))

    async def get_status(self, *, timeout: float | None = None) -> CameraStatus:
        """Request the mode, zoom and focus (CAMERA_SETTINGS).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The status.

        Raises:
            CommandDenied: The camera does not report it.
            MessageTimeout: The camera does not answer.
        """
        operation = RequestReport(common.CameraSettings, self.device_id, timeout=timeout)
        return CameraStatus.read(await self._run(operation))

    async def get_capture_status(self, *, timeout: float | None = None) -> CaptureStatus:
        """Request the state of captures (CAMERA_CAPTURE_STATUS).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The status.

        Raises:
            CommandDenied: The camera does not report it.
            MessageTimeout: The camera does not answer.
        """
        operation = RequestReport(common.CameraCaptureStatus, self.device_id, timeout=timeout)
        return CaptureStatus.read(await self._run(operation))

    async def list_storages(self, *, timeout: float | None = None) -> tuple[Storage, ...]:
        """List the storages of the camera's component (STORAGE_INFORMATION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The storages.

        Raises:
            CommandDenied: The component has no storage.
            MessageTimeout: The component does not answer.
        """
        return await self._run(ListStorages(timeout=timeout))

    async def list_streams(self, *, timeout: float | None = None) -> tuple[VideoStream, ...]:
        """List the video streams (VIDEO_STREAM_INFORMATION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The streams.

        Raises:
            CommandDenied: The camera has no video stream.
            MessageTimeout: The camera does not answer.
        """
        return await self._run(ListStreams(self.device_id, timeout=timeout))

    @cached_property
    def settings(self) -> CameraSettings:
        """The settings, with their options from the camera definition file."""
        return CameraSettings(self._clients, self.get_information)

    def __repr__(self) -> str:
        attached = f" device {self.device_id}" if self.device_id else ""
        return f"<Camera {self.address}{attached}>"
