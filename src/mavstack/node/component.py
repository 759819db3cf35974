"""A remote component and its parts: commands, messages, parameters, files, logs, modes, plans, payloads.

Each part (`params`, `mission` …) is created on first use. Operations run concurrently; those that the
protocol forbids to overlap are queued. Every call ends with its result or a typed error of `mavstack.errors`,
and a cancelled task cancels the operation on both ends.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.node.clients import ComponentClients
from mavstack.node.control_streams import ControlStreams
from mavstack.node.events import EventParts
from mavstack.node.extended_params import ExtendedParams
from mavstack.node.ftp import Ftp
from mavstack.node.logs import Logs
from mavstack.node.modes import Modes
from mavstack.node.params import Params
from mavstack.node.payloads import PayloadParts
from mavstack.node.plans import PlanParts
from mavstack.node.read_only import ReadOnly
from mavstack.node.subscription import DEFAULT_QUEUE
from mavstack.node.terrain import Terrain
from mavstack.services.command import Command, CommandOperation
from mavstack.services.message_request import GetMessageInterval, Interval, RequestMessage, SetMessageInterval
from mavstack.services.version import RequestAutopilotVersion, RequestProtocolVersion

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.links import Channel
    from mavstack.node.dispatch import Listener
    from mavstack.node.host import NodeHost
    from mavstack.node.subscription import Subscription
    from mavstack.security import SigningKey
    from mavstack.services import Address
    from mavstack.services.command import CommandResult
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.services.message_request import RateSet
    from mavstack.services.ping import PingStatistics
    from mavstack.services.timesync import TimesyncClient
    from mavstack.services.version import AutopilotVersion, ProtocolVersion

AnyMessage = TypeVar("AnyMessage", bound="Message")


class RemoteComponent(EventParts, PayloadParts, PlanParts, ControlStreams, ReadOnly):
    """A component of another system; from `Node.component`, `wait_for_autopilot` or `wait_for_component`."""

    _constructed = frozenset({"address"})

    def __init__(self, host: NodeHost, address: Address) -> None:
        #: The component's system and component id.
        self.address = address
        self._host = host
        self._clients = ComponentClients(host, address)

    @property
    def info(self) -> ComponentInfo | None:
        """The component's last heartbeat; None if none was received."""
        return self._clients.info

    @property
    def channels(self) -> tuple[str, ...]:
        """The names of the open channels on which the component was heard."""
        return tuple(channel.name for channel in self._host.engine.routes.heard_on(self.address))

    @property
    def is_open(self) -> bool:
        """True while the node is open, so that the component can be reached."""
        return self._host.is_open

    def now(self) -> float:
        """Return the time of services: Unix seconds that never decrease.

        Raises:
            InvalidStateError: The node is closed.
        """
        return self._host.now()

    def clear_cache(self) -> None:
        """Discard state cached before a reboot: parameters, capabilities, modes, mission progress.

        Running operations continue. The node calls this when it detects a reboot.
        """
        self._clients.clear_cache()
        if "params" in self.__dict__:
            self.params.clear_cache()
        if "_event_metadata" in self.__dict__:
            self._event_metadata.clear_cache()

    async def command(
        self,
        command: int,
        *params: float,
        frame: int | None = None,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> CommandResult:
        """Send a MAV_CMD, repeat it until it is acknowledged, and wait for its end.

        Args:
            command: The MAV_CMD.
            params: Up to seven parameters, in the units of the command's definition; missing ones are 0.
            frame: A MAV_FRAME: send COMMAND_INT, with params 5 and 6 in degrees or metres. None:
                COMMAND_LONG.
            timeout: Seconds for the whole call; None: until retries are exhausted or no more
                IN_PROGRESS is received.
            progress: Called with the percentage done and 100 while a long command runs.

        Returns:
            The result and its additional data (COMMAND_ACK).

        Raises:
            CommandDenied: The component answered with another result than ACCEPTED; `code` is the MAV_RESULT.
            CommandTimeout: The component does not answer.
            RemoteCancelled: The node was closed, or a disarming superseded this arming.
        """
        named = self._host.named_command(command)
        operation = CommandOperation(Command.of(named, params, frame), timeout=timeout)
        return await self._host.run_operation(self._clients.command, operation, progress)

    async def request_message(
        self, message: type[AnyMessage], *params: float, timeout: float | None = None
    ) -> AnyMessage:
        """Request one message (MAV_CMD_REQUEST_MESSAGE).

        Args:
            message: The message class.
            params: Params 2 to 6 of the command, whose meaning depends on the message.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The message.

        Raises:
            CommandDenied: The component refused the request.
            MessageTimeout: The component does not answer, or does not send the message.
        """
        operation = RequestMessage(message, params, timeout=timeout)
        answer: AnyMessage = await self._host.run_operation(self._clients.command, operation)
        return answer

    async def set_message_rate(
        self, message: type[Message] | int, rate: Interval | float, *, timeout: float | None = None
    ) -> RateSet:
        """Set the rate at which the component sends a message (MAV_CMD_SET_MESSAGE_INTERVAL).

        Args:
            message: The message class or id.
            rate: Hertz (0: off), or an `Interval` such as `Interval.DEFAULT` or `Interval.OFF`.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            How the rate was set: per message, or by the legacy request for a whole data stream.

        Raises:
            CommandDenied: The component refused the rate.
            CommandTimeout: The component does not answer.
        """
        interval = rate if isinstance(rate, Interval) else Interval.hertz(rate)
        operation = SetMessageInterval(message, interval, timeout=timeout)
        return await self._host.run_operation(self._clients.command, operation)

    async def get_message_interval(
        self, message: type[Message] | int, *, timeout: float | None = None
    ) -> Interval:
        """Get the interval at which the component sends a message (MESSAGE_INTERVAL).

        Args:
            message: The message class or id.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The interval, with `seconds` between two messages.

        Raises:
            CommandDenied: The component refused the request.
            MessageTimeout: The component does not answer.
        """
        operation = GetMessageInterval(message, timeout=timeout)
        return await self._host.run_operation(self._clients.command, operation)

    async def get_version(self, *, timeout: float | None = None) -> AutopilotVersion:
        """Get the component's software and hardware versions and capabilities (AUTOPILOT_VERSION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The versions, the unique id and the MAV_PROTOCOL_CAPABILITY flags.

        Raises:
            CommandDenied: The component refused the request.
            MessageTimeout: The component does not answer.
        """
        operation = RequestAutopilotVersion(timeout=timeout)
        return await self._host.run_operation(self._clients.command, operation)

    async def get_protocol_version(self, *, timeout: float | None = None) -> ProtocolVersion:
        """Get the MAVLink versions that the component supports (PROTOCOL_VERSION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The current, the oldest and the newest version.

        Raises:
            CommandDenied: The component refused the request.
            MessageTimeout: The component does not answer.
        """
        operation = RequestProtocolVersion(timeout=timeout)
        return await self._host.run_operation(self._clients.command, operation)

    async def ping(self, count: int = 4, *, timeout: float | None = None) -> PingStatistics:
        """Measure the round-trip time to the component (PING).

        Args:
            count: Pings to send, one per second.
            timeout: Seconds for the whole call; None: until two seconds after the last ping.

        Returns:
            The round-trip times in seconds, and how many pings were sent and answered.

        Raises:
            InvalidArgumentError: `count` is less than 1.
            RemoteTimeout: The component answers no ping.
        """
        client = self._clients.ping
        return await self._host.finish(client, client.ping(self._host.now(), count=count, timeout=timeout))

    def stream(
        self, *messages: type[AnyMessage], queue: int = DEFAULT_QUEUE, keep_all: bool = False
    ) -> Subscription[AnyMessage]:
        """Subscribe to messages of the component.

        Args:
            messages: Message classes; none: every message that the dialect defines.
            queue: Messages that are queued while the program does not read; then the oldest is dropped.
            keep_all: Queue without limit and drop nothing.

        Returns:
            An async iterator over the messages; close it, or use it as an async context manager.
        """
        return self._host.stream(messages, self.address, queue=queue, keep_all=keep_all)

    def add_listener(
        self,
        kind: type[AnyMessage] | tuple[type[AnyMessage], ...],
        callback: Callable[[AnyMessage], None],
    ) -> Listener:
        """Call a function with each message of a class that the component sends, as soon as it is received.

        Args:
            kind: A message class, or a tuple of them.
            callback: The function. It must return quickly, since it runs in the event loop.

        Returns:
            The listener; its `close()` ends the calls.
        """
        return self._host.add_listener(kind, callback, self.address)

    def send(self, message: Message) -> None:
        """Send a message to the component; its target fields, if it has any, are filled in.

        Args:
            message: The message.

        Raises:
            InvalidStateError: The node is closed.
            EncodeError: The message cannot be encoded in the node's MAVLink version.
        """
        fields: dict[str, Any] = dict(zip(("target_system", "target_component"), self.address, strict=True))
        known = {name: value for name, value in fields.items() if name in message.__match_args__}
        self._host.send(message.replace(**known), self.address)

    # Parameters, files, logs, modes, keys

    @cached_property
    def params(self) -> Params:
        """The component's parameters."""
        return Params(self._clients)

    @cached_property
    def extended_params(self) -> ExtendedParams:
        """The component's extended parameters, as cameras have them."""
        return ExtendedParams(self._clients)

    @cached_property
    def ftp(self) -> Ftp:
        """The component's files, by MAVLink FTP."""
        return Ftp(self._clients)

    @cached_property
    def logs(self) -> Logs:
        """The component's logs."""
        return Logs(self._clients)

    @cached_property
    def modes(self) -> Modes:
        """The component's flight modes."""
        return Modes(self._clients)

    async def setup_signing(
        self, key: SigningKey | None, *, channel: Channel | str | None = None, timeout: float | None = None
    ) -> None:
        """Install a signing key on the component (SETUP_SIGNING), and use it once the component uses it.

        Args:
            key: The key; None: remove the present key.
            channel: The channel, or its name, for a first key, which is sent in the clear: one that no other
                program can hear. None: only channels on which the component was verified.
            timeout: Seconds for the whole call; None: until no answer was received for 40 seconds.

        Raises:
            SigningError: No channel was named, and the component was not verified on those that lead to it.
            InvalidArgumentError: There is no open channel of that name.
            RemoteDenied: The component refused the key. Both sides keep the present key.
            RemoteTimeout: The component does not answer. Both sides keep the present key.
        """
        name = channel if channel is None or isinstance(channel, str) else channel.name
        await self._clients.setup_signing(key, name, timeout)

    @cached_property
    def terrain(self) -> Terrain:
        """The terrain that the component, a vehicle, has from ground stations."""
        return Terrain(self._clients)

    @property
    def clock(self) -> TimesyncClient:
        """The client that follows the component's clock (TIMESYNC), from the first use on; see `estimate`."""
        return self._clients.clock

    def __repr__(self) -> str:
        return f"<RemoteComponent {self.address}>"
