"""The cameras and gimbals of a remote component."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError
from mavstack.node.camera import Camera
from mavstack.node.gimbal import Gimbal
from mavstack.services.camera import ListCameras
from mavstack.services.gimbal import ListGimbals

if TYPE_CHECKING:
    from mavstack.node.clients import ComponentClients

#: The largest device id of cameras that are attached to an autopilot, and of component ids.
_MAX_ATTACHED, _MAX_COMPONENT = 6, 255


class PayloadParts:
    """The part of a remote component that reaches its cameras and gimbals."""

    _clients: ComponentClients

    @cached_property
    def camera(self) -> Camera:
        """The component as a camera (camera protocol v2)."""
        return Camera(self._clients)

    @cached_property
    def gimbal(self) -> Gimbal:
        """All gimbals that the component manages, as one (gimbal protocol v2)."""
        return Gimbal(self._clients)

    def attached_camera(self, device_id: int) -> Camera:
        """Return a camera that is attached to this autopilot.

        Args:
            device_id: 1 to 6.

        Returns:
            The camera; the same object for the same id.

        Raises:
            InvalidArgumentError: The id is out of range.
        """
        if not 1 <= device_id <= _MAX_ATTACHED:
            raise InvalidArgumentError(f"attached cameras have ids from 1 to 6, got {device_id}")
        return self._attached_cameras.setdefault(device_id, Camera(self._clients, device_id))

    def gimbal_device(self, device_id: int) -> Gimbal:
        """Return one of the gimbals that the component manages.

        Args:
            device_id: 1 to 6, or the component id of the gimbal device.

        Returns:
            The gimbal; the same object for the same id.

        Raises:
            InvalidArgumentError: The id is out of range.
        """
        if not 1 <= device_id <= _MAX_COMPONENT:
            raise InvalidArgumentError(f"gimbal devices have ids from 1 to 255, got {device_id}")
        return self._gimbal_devices.setdefault(device_id, Gimbal(self._clients, device_id))

    async def list_cameras(self, *, timeout: float | None = None) -> tuple[Camera, ...]:
        """List the cameras of the component: itself, or those attached to an autopilot (CAMERA_INFORMATION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The cameras; none if the component has no camera.

        Raises:
            MessageTimeout: The component does not answer.
        """
        found = await self._clients.host.run_operation(self._clients.command, ListCameras(timeout=timeout))
        own = (self.attached_camera(each.device_id) if each.device_id else self.camera for each in found)
        return tuple(own)

    async def list_gimbals(self, *, timeout: float | None = None) -> tuple[Gimbal, ...]:
        """List the gimbals that the component manages (GIMBAL_MANAGER_INFORMATION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The gimbals; none if the component manages no gimbal.

        Raises:
            MessageTimeout: The component does not answer.
        """
        _ = self._clients.gimbals  # receives what the component tells of its gimbals
        found = await self._clients.host.run_operation(self._clients.command, ListGimbals(timeout=timeout))
        return tuple(self.gimbal_device(each.device_id) for each in found if each.device_id)

    @cached_property
    def _attached_cameras(self) -> dict[int, Camera]:
        return {}

    @cached_property
    def _gimbal_devices(self) -> dict[int, Gimbal]:
        return {}
