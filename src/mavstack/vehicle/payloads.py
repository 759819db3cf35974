"""The cameras and gimbals of a vehicle.

A camera is a component of the vehicle's system, found by its heartbeat, or it is attached to the autopilot,
which is asked for it. An id means what it means in missions: 1 to 6 is an attached camera, a larger one the
component id of a camera. The gimbal manager is mostly the autopilot; a companion computer or a camera may be
one too.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import ActionUnsupported, InvalidArgumentError, RemoteError
from mavstack.services import DEFAULT_WAIT_TIMEOUT

if TYPE_CHECKING:
    from mavstack.node.camera import Camera
    from mavstack.node.gimbal import Gimbal
    from mavstack.vehicle.vehicle import Vehicle

_TYPE = common.MavType
#: The types of components that may manage gimbals, in addition to the autopilot.
_MANAGERS = (_TYPE.GIMBAL, _TYPE.CAMERA, _TYPE.ONBOARD_CONTROLLER)
_MAX_ATTACHED, _MAX_COMPONENT = 6, 255


def alive_cameras(vehicle: Vehicle) -> tuple[Camera, ...]:
    """Return the cameras whose heartbeats arrive."""
    return tuple(
        vehicle.connection.component(vehicle.system, number).camera
        for number, info in sorted(vehicle.components.items())
        if info.type == _TYPE.CAMERA and info.alive
    )


def camera(vehicle: Vehicle, component: int | None = None) -> Camera:
    """Return a camera of the vehicle.

    Args:
        component: The component id of the camera, or 1 to 6 for one that is attached to the autopilot;
            None: the first one that is known.

    Returns:
        The camera.

    Raises:
        InvalidArgumentError: The id is out of range.
        ActionUnsupported: No camera of the vehicle is known.
    """
    if component is None:
        known = vehicle.cameras
        if not known:
            raise ActionUnsupported(
                f"no camera of vehicle {vehicle.system} is known; await vehicle.wait_for_camera(), "
                "or find_cameras() for cameras that are attached to the autopilot"
            )
        return known[0]
    if not 1 <= component <= _MAX_COMPONENT:
        raise InvalidArgumentError(f"a camera has an id from 1 to 255, got {component}")
    if component <= _MAX_ATTACHED:
        return vehicle.component.attached_camera(component)
    return vehicle.connection.component(vehicle.system, component).camera


async def wait_for_camera(
    vehicle: Vehicle, component: int | None = None, *, timeout: float | None = DEFAULT_WAIT_TIMEOUT
) -> Camera:
    """Wait for the heartbeat of a camera of the vehicle.

    Args:
        component: The component id of the camera; None: the first one.
        timeout: Seconds to wait; None waits for ever.

    Returns:
        The camera.

    Raises:
        RemoteTimeout: There was none in time; the text names the components that were heard.
    """
    number = "" if component is None else f" {component}"
    found = await vehicle.connection.wait_for_component(
        lambda info: (
            info.address.system == vehicle.system
            and info.type == _TYPE.CAMERA
            and component in (None, info.address.component)
        ),
        f"camera{number} of vehicle {vehicle.system}" if number else f"a camera of vehicle {vehicle.system}",
        timeout=timeout,
    )
    return found.camera


async def find_gimbals(vehicle: Vehicle, *, timeout: float | None = None) -> tuple[Gimbal, ...]:
    """Ask the autopilot and the other components for the gimbals that they manage.

    Args:
        timeout: Seconds for the whole call; None: until retries are exhausted.

    Returns:
        The gimbals; those of the autopilot first.

    Raises:
        MessageTimeout: The autopilot does not answer.
    """
    others = [number for number, info in sorted(vehicle.components.items()) if info.type in _MANAGERS]
    managers = [vehicle.connection.component(vehicle.system, number) for number in others]
    answers = await asyncio.gather(
        vehicle.component.list_gimbals(timeout=timeout),
        *(manager.list_gimbals(timeout=timeout) for manager in managers),
        return_exceptions=True,
    )
    found: list[Gimbal] = []
    for number, answer in enumerate(answers):
        if isinstance(answer, BaseException):
            if number and isinstance(answer, RemoteError):
                continue  # a payload that does not answer must not hide the gimbals of the autopilot
            raise answer
        found += answer
    return tuple(found)
