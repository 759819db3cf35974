"""The camera that a command acts on: `--camera`, or the only one of the vehicle."""

from __future__ import annotations

from argparse import ArgumentTypeError
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.errors import MessageTimeout, RemoteTimeout

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.node.camera import Camera
    from mavstack.vehicle import Vehicle

#: Seconds to wait for the heartbeat of a camera; then the autopilot is asked for attached cameras.
HEARTBEAT_TIMEOUT: Final = 3.0


def add_camera_option(parser: ArgumentParser) -> None:
    """Declare `--camera`."""
    parser.add_argument(
        "--camera",
        type=payload_id,
        metavar="ID",
        help="component id of the camera (100 to 105), or 1 to 6 if attached to the autopilot",
    )


def payload_id(text: str) -> int:
    """Parse a component id, or the device id of an attached payload, for argparse."""
    if not (text.isdecimal() and 1 <= int(text) <= 255):
        raise ArgumentTypeError(f"{text!r} is not an id from 1 to 255")
    return int(text)


async def selected_camera(vehicle: Vehicle, arguments: Namespace) -> Camera:
    """Return the camera that `--camera` names, or the only one of the vehicle.

    Raises:
        UsageError: The vehicle has several cameras, and none was named.
        CommandError: The vehicle has no camera.
    """
    if arguments.camera is not None:
        return vehicle.camera(arguments.camera)
    cameras = await known_cameras(vehicle)
    if not cameras:
        raise CommandError(f"vehicle {vehicle.system} has no camera: none sent a heartbeat or is attached")
    if len(cameras) > 1:
        ids = ", ".join(str(each.device_id or each.address.component) for each in cameras)
        raise UsageError(f"vehicle {vehicle.system} has several cameras ({ids}); select one with --camera ID")
    return cameras[0]


async def known_cameras(vehicle: Vehicle) -> tuple[Camera, ...]:
    """Return all cameras of a vehicle; waits a moment for the first heartbeat of one."""
    if not vehicle.cameras:
        with suppress(RemoteTimeout):  # a camera that is attached to the autopilot sends no heartbeat
            await vehicle.wait_for_camera(timeout=HEARTBEAT_TIMEOUT)
    try:
        return await vehicle.find_cameras()
    except MessageTimeout:
        return vehicle.cameras
