"""The devices and data that a node offers to other components.

The functions are methods of `Node`, which binds them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.arm_authorization import ArmRefusal, send_answer
from mavstack.services.camera import CameraServer
from mavstack.services.gimbal import GimbalManagerServer
from mavstack.services.rtk import ChannelPace, CorrectionSender
from mavstack.services.terrain import TerrainServer

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from mavstack.node.node import Node
    from mavstack.services.arm_authorization import ArmApproval
    from mavstack.services.camera import CameraDevice
    from mavstack.services.command import CommandRequest
    from mavstack.services.gimbal import GimbalDevice
    from mavstack.services.terrain import Heights


def serve_camera(node: Node, *devices: CameraDevice) -> CameraServer:
    """Offer a camera by the camera protocol v2, or several that are attached to this autopilot.

    Args:
        devices: The camera; for attached cameras each with a device id from 1 to 6.

    Returns:
        The server of the cameras.

    Raises:
        InvalidArgumentError: There is no camera, or two have one device id.
    """
    server = CameraServer(node.address, devices)
    server.answer(node.commands.server, node.message_server)
    node.wake(node.message_server)
    return node.serve(server)


def serve_gimbal(node: Node, *devices: GimbalDevice) -> GimbalManagerServer:
    """Offer gimbals by the gimbal protocol v2, as their gimbal manager.

    Args:
        devices: The gimbals, each with a device id of its own.

    Returns:
        The server of the gimbals.

    Raises:
        InvalidArgumentError: There is no gimbal, or two have one device id.
    """
    server = GimbalManagerServer(node.address, devices)
    server.answer(node.commands.server, node.message_server)
    node.wake(node.message_server)
    return node.serve(server)


def serve_arm_authorization(node: Node, decide: Callable[[int], Awaitable[ArmApproval | ArmRefusal]]) -> None:
    """Decide whether vehicles may arm (MAV_CMD_ARM_AUTHORIZATION_REQUEST).

    The vehicle has the system id of this node as the one of its authoriser; PX4 in COM_ARM_AUTH_ID.

    Args:
        decide: An async function that gets the system id of a vehicle, and returns an `ArmApproval` or an
            `ArmRefusal`. Meanwhile the vehicle gets IN_PROGRESS. After an exception it is refused.
    """
    commands = node.commands

    async def answer(request: CommandRequest) -> None:
        outcome: ArmApproval | ArmRefusal = ArmRefusal()
        try:
            outcome = await decide(request.source.system)
        finally:
            send_answer(commands.server, request, outcome)
            node.wake(commands.server)

    commands._run_as_task(  # noqa: SLF001 (of the same package)
        common.MavCmd.ARM_AUTHORIZATION_REQUEST, answer, none_is_pending=True
    )


def serve_terrain(node: Node, heights: Heights) -> TerrainServer:
    """Send the terrain that vehicles ask for (TERRAIN_REQUEST, TERRAIN_DATA).

    Args:
        heights: Called with a latitude and a longitude in degrees; returns the height of the terrain in
            metres above mean sea level, or None if it is not known. It must return quickly, since it runs
            in the event loop, 16 times for each tile.

    Returns:
        The server; its `sent` and `unknown` count the tiles.
    """
    return node.serve(TerrainServer(node.address, heights))


def correction_sender(node: Node) -> CorrectionSender:
    """Return a sender of corrections over all channels of a node."""

    def paces() -> list[ChannelPace]:
        channels = node._host.engine.channels  # noqa: SLF001 (the node of these functions)
        return [ChannelPace(channel.name, channel.pacer.bandwidth) for channel in channels]

    return CorrectionSender(node.address, paces)
