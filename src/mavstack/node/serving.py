"""The services of a node: those that the local component offers, and operations of its clients."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import common
from mavstack.node.api_object import LoopBound
from mavstack.node.command_handlers import CommandHandlers
from mavstack.node.key_change import trusted_channels
from mavstack.node.parts import Part
from mavstack.services.camera import CameraServer
from mavstack.services.gimbal import GimbalManagerServer
from mavstack.services.message_request import MessageServer
from mavstack.services.statustext import StatustextSender
from mavstack.services.terrain import TerrainServer

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.links import Channel
    from mavstack.node.channel_state import ChannelState
    from mavstack.node.host import NodeHost
    from mavstack.services import Client, Operation, Service
    from mavstack.services.camera import CameraDevice
    from mavstack.services.gimbal import GimbalDevice
    from mavstack.services.heartbeat import HeartbeatSender
    from mavstack.services.signing_setup import SigningRequest
    from mavstack.services.terrain import Heights

AnyService = TypeVar("AnyService", bound="Service")
AnyHandler = TypeVar("AnyHandler", bound="Callable[..., Any]")
Result = TypeVar("Result")


class Serving(LoopBound):
    """The part of a node that runs services."""

    _host: NodeHost
    _heartbeat: HeartbeatSender
    _sends_heartbeat: bool

    # Parts

    commands = Part(
        CommandHandlers,
        "The handlers of commands that remote components send to this node.",
        lambda node: CommandHandlers(node._host),  # noqa: SLF001 (a part of this class)
    )
    message_server = Part(
        MessageServer,
        "The server of the messages that were given to `publish`.",
        lambda node: node.serve(MessageServer(node.address, node.commands.server)),
    )
    _statustext_sender = Part(
        StatustextSender,
        "The sender of status texts.",
        lambda node: node.serve(StatustextSender(node.address)),
    )

    def serve(self, service: AnyService) -> AnyService:
        """Run a service on this node, now or as soon as the node opens.

        Args:
            service: The service, such as a `FtpServer` with this node's address.

        Returns:
            The service.
        """
        return self._host.serve(service)

    def wake(self, service: Service) -> None:
        """Process a service after the program called one of its methods: its messages, events and timer.

        Args:
            service: A service that was given to `serve`.
        """
        self._host.wake(service)

    async def run_operation(
        self,
        client: Client,
        operation: Operation[Result],
        progress: Callable[[int, int], None] | None = None,
    ) -> Result:
        """Run an operation of a client that was given to `serve`; a cancelled task cancels it on both ends.

        Args:
            client: The client.
            operation: The operation, not started yet.
            progress: Called with the units done and in total.

        Returns:
            The result of the operation.

        Raises:
            RemoteError: The operation failed; a subclass says how.
            InvalidStateError: The node is closed.
        """
        return await self._host.run_operation(client, operation, progress)

    def now(self) -> float:
        """Return the time of services: Unix seconds that never decrease.

        Raises:
            InvalidStateError: The node is closed.
        """
        return self._host.now()

    def set_heartbeat(
        self,
        *,
        base_mode: int | None = None,
        custom_mode: int | None = None,
        system_status: int | None = None,
    ) -> None:
        """Change fields of the node's own HEARTBEAT; the next HEARTBEAT is sent immediately.

        Args:
            base_mode: MAV_MODE_FLAG flags; None: unchanged.
            custom_mode: The firmware's mode number; None: unchanged.
            system_status: A MAV_STATE; None: unchanged.
        """
        heartbeat = self._heartbeat
        heartbeat.base_mode = heartbeat.base_mode if base_mode is None else base_mode
        heartbeat.custom_mode = heartbeat.custom_mode if custom_mode is None else custom_mode
        heartbeat.system_status = heartbeat.system_status if system_status is None else system_status
        if self._host.is_open and self._sends_heartbeat:
            heartbeat.send_now(self.now())
            self.wake(heartbeat)

    def publish(
        self, message: type[Message], producer: Callable[[float], Message | None], *, interval: float = 0.0
    ) -> None:
        """Publish a message: at an interval, at the rates that remote components set, and on request.

        Args:
            message: The message class.
            producer: Called with the time; returns the message, or None if there is none to send.
            interval: Seconds between two messages; 0: only on request, and at rates that are set.
        """
        self.message_server.provide(message, producer, interval=interval)
        self.wake(self.message_server)

    def send_statustext(self, text: str, severity: int = common.MavSeverity.INFO) -> None:
        """Send a status text to all components (STATUSTEXT); a long text is sent in chunks.

        Args:
            text: The text.
            severity: The MAV_SEVERITY.
        """
        self._statustext_sender.send_text(text, severity)
        self.wake(self._statustext_sender)

    def serve_camera(self, *devices: CameraDevice) -> CameraServer:
        """Offer a camera by the camera protocol v2, or several that are attached to this autopilot.

        Args:
            devices: The camera; for attached cameras each with a device id from 1 to 6.

        Returns:
            The server of the cameras.

        Raises:
            InvalidArgumentError: There is no camera, or two have one device id.
        """
        server = CameraServer(self._host.address, devices)
        server.answer(self.commands.server, self.message_server)
        self.wake(self.message_server)
        return self.serve(server)

    def serve_gimbal(self, *devices: GimbalDevice) -> GimbalManagerServer:
        """Offer gimbals by the gimbal protocol v2, as their gimbal manager.

        Args:
            devices: The gimbals, each with a device id of its own.

        Returns:
            The server of the gimbals.

        Raises:
            InvalidArgumentError: There is no gimbal, or two have one device id.
        """
        server = GimbalManagerServer(self._host.address, devices)
        server.answer(self.commands.server, self.message_server)
        self.wake(self.message_server)
        return self.serve(server)

    def serve_terrain(self, heights: Heights) -> TerrainServer:
        """Send the terrain that vehicles ask for (TERRAIN_REQUEST, TERRAIN_DATA).

        Args:
            heights: Called with a latitude and a longitude in degrees; returns the height of the terrain in
                metres above mean sea level, or None if it is not known. It must return quickly, since it runs
                in the event loop, 16 times for each tile.

        Returns:
            The server; its `sent` and `unknown` count the tiles.
        """
        return self.serve(TerrainServer(self._host.address, heights))

    def on_command(self, command: int) -> Callable[[AnyHandler], AnyHandler]:
        """Register a function, plain or async, as the handler of a command; see `CommandHandlers`.

        Args:
            command: The MAV_CMD.

        Returns:
            A decorator for the function.
        """
        return self.commands.register(command)

    def channel_state(self, channel: Channel) -> ChannelState | None:
        """Return the signing state, pace and statistics of a channel.

        Args:
            channel: A channel of one of the node's links.

        Returns:
            The state; None if the channel is closed. Its `trusted` allows `trusted_channel_policy`.
        """
        driver = self._host.open_driver
        return driver.channels.get(channel) if driver is not None else None

    def trusted_channel_policy(self) -> Callable[[SigningRequest], str | None]:
        """Return the policy for a `SigningSetupServer` that accepts keys over trusted channels alone.

        Returns:
            The policy. A channel is trusted once the program sets `channel_state(channel).trusted`.
        """
        return trusted_channels(self._host.engine)
