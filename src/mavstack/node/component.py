"""A remote component and its parts: commands, messages, parameters, files, logs, modes, plans, payloads.

Each part (`params`, `mission` …) is created on first use. Operations run concurrently; those that the
protocol forbids to overlap are queued. Every call ends with its result or a typed error of `mavstack.errors`,
and a cancelled task cancels the operation on both ends.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.errors import InvalidArgumentError
from mavstack.node.api_object import ReadOnly
from mavstack.node.camera import Camera
from mavstack.node.can import Can
from mavstack.node.clients import ComponentClients
from mavstack.node.control import ControlStream
from mavstack.node.events import EventListener, EventMetadata, EventStream
from mavstack.node.extended_params import ExtendedParams
from mavstack.node.failure import Failure
from mavstack.node.ftp import Ftp
from mavstack.node.gimbal import Gimbal
from mavstack.node.log_stream import LogStreams
from mavstack.node.logs import Logs
from mavstack.node.metadata_files import MetadataAccess
from mavstack.node.modes import Modes
from mavstack.node.params import USER_CACHE, Params
from mavstack.node.parts import Part, clear_caches
from mavstack.node.plans import Plans
from mavstack.node.serial_port import SerialPorts
from mavstack.node.shell import Shell
from mavstack.node.signing_setup import setup_signing
from mavstack.node.subscription import DEFAULT_QUEUE
from mavstack.node.terrain import Terrain
from mavstack.node.time_budget import TimeBudget
from mavstack.services.addressing import target_fields
from mavstack.services.arguments import check_number
from mavstack.services.camera import ListCameras
from mavstack.services.command import Command, CommandOperation
from mavstack.services.events import EventReceived, EventReceiver, EventsLost, LogLevel
from mavstack.services.gimbal import GimbalMonitor, ListGimbals
from mavstack.services.manual_control import ManualControlSender, OverrideSender
from mavstack.services.message_request import GetMessageInterval, Interval, RequestMessage, SetMessageInterval
from mavstack.services.mission import PlanType
from mavstack.services.ping import PingClient
from mavstack.services.setpoints import SetpointStreamer
from mavstack.services.timesync import TimesyncClient
from mavstack.services.version import RequestAutopilotVersion, RequestProtocolVersion

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.dialects import Message
    from mavstack.files.parameter_metadata import MetadataCache
    from mavstack.links import Channel
    from mavstack.node.dispatch import Listener
    from mavstack.node.host import NodeHost
    from mavstack.node.subscription import Subscription
    from mavstack.security import SigningKey
    from mavstack.services import Address, Service
    from mavstack.services.command import CommandResult
    from mavstack.services.events import DecodedEvent, EventDefinition
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.services.manual_control import ChannelOverride, ManualInput
    from mavstack.services.message_request import RateSet
    from mavstack.services.ping import PingStatistics
    from mavstack.services.setpoints import Setpoint
    from mavstack.services.version import AutopilotVersion, ProtocolVersion

AnyMessage = TypeVar("AnyMessage", bound="Message")
Made = TypeVar("Made")

#: The largest device id of a camera that is attached to an autopilot, and the largest component id.
_MAX_ATTACHED, _MAX_COMPONENT = 6, 255


def _part(
    kind: type[Made],
    doc: str,
    *arguments: int,
    clear_cache: Callable[[Made], object] | None = None,
    server: Callable[[Address], Service] | None = None,
    offered: bool = False,
) -> Part[Made]:
    """Declare a part that is made from the clients of a component, and from further arguments."""

    def make(component: RemoteComponent) -> Made:
        made: Callable[..., Made] = kind
        return made(component._clients, *arguments)  # noqa: SLF001 (a part of this class)

    return Part(kind, doc, make, clear_cache=clear_cache, server=server, offered=offered)


class RemoteComponent(ReadOnly):
    """A component of another system; from `Node.component`, `wait_for_autopilot` or `wait_for_component`."""

    address: Address

    # Parts of the API

    params = _part(Params, "The component's parameters.", clear_cache=Params.clear_cache)
    extended_params = _part(ExtendedParams, "The component's extended parameters, as cameras have them.")
    mission = _part(Plans, "The component's mission.", PlanType.MISSION)
    fence = _part(Plans, "The component's geofence.", PlanType.FENCE)
    rally = _part(Plans, "The component's rally points.", PlanType.RALLY)
    modes = _part(Modes, "The component's flight modes.")
    ftp = _part(Ftp, "The component's files, by MAVLink FTP.")
    logs = _part(Logs, "The component's logs.")
    log_stream = _part(LogStreams, "The component's log while it is written.")
    camera = _part(Camera, "The component as a camera (camera protocol v2).")
    gimbal = _part(Gimbal, "All gimbals that the component manages, as one (gimbal protocol v2).")
    can = _part(Can, "The CAN buses of the component, an autopilot.")
    serial = _part(SerialPorts, "The serial ports of the component, an autopilot.")
    failure = _part(Failure, "Failures that the component, a vehicle, simulates on purpose.", offered=True)
    terrain = _part(
        Terrain, "The terrain that the component, a vehicle, has from ground stations.", offered=True
    )
    _event_metadata = _part(EventMetadata, "The words of its events.", clear_cache=EventMetadata.clear_cache)

    def __init__(self, host: NodeHost, address: Address) -> None:
        #: The component's system and component id.
        self.address = address
        self._host = host
        self._clients = ComponentClients(host, address)
        self._attached_cameras: dict[int, Camera] = {}
        self._gimbal_devices: dict[int, Gimbal] = {}

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
        clear_caches(self)

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
        client = self._clients.get(PingClient)
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

    def send(self, message: Message, *, at_once: bool = False) -> None:
        """Send a message to the component; its target fields, if it has any, are filled in.

        Args:
            message: The message.
            at_once: Write it now, as a measurement whose age counts; False: at the end of this turn of the
                event loop, together with other messages, which costs less for many of them.

        Raises:
            InvalidStateError: The node is closed.
            EncodeError: The message cannot be encoded in the node's MAVLink version.
        """
        if fields := target_fields(type(message)):
            values: dict[str, Any] = dict(zip(fields, self.address, strict=False))
            message = message.replace(**values)
        self._host.send(message, self.address, at_once=at_once)

    # Events

    def events(self, *, severity: int = LogLevel.DEBUG, queue: int = DEFAULT_QUEUE) -> EventStream:
        """Subscribe to the events of the component (EVENT); missing ones are requested again.

        Args:
            severity: The least severe level to deliver, a MAV_SEVERITY or `LogLevel`; `LogLevel.DISABLED`:
                every event, also those that are for programs only.
            queue: Events that are queued while the program does not read; then the oldest is dropped.

        Returns:
            An async iterator of the events, with the words of the component's metadata.

        Raises:
            InvalidTypeError: The severity is not a number.
            InvalidArgumentError: The severity is not from 0 to 9.
        """
        check_number("severity", severity)
        if not 0 <= severity <= LogLevel.DISABLED:
            raise InvalidArgumentError(f"severity must be from 0 to {int(LogLevel.DISABLED)}, got {severity}")
        host, receiver = self._clients.host, self._clients.get(EventReceiver)
        subscription = host.events(EventReceived, EventsLost, of=receiver, queue=queue)
        return EventStream(subscription, self._event_metadata, severity)

    def add_event_listener(
        self, callback: Callable[[DecodedEvent], object], *, severity: int = LogLevel.DEBUG
    ) -> EventListener:
        """Call a function with each event of the component (EVENT); missing ones are requested again.

        Args:
            callback: The function. It must return quickly, since it runs in the event loop.
            severity: The least severe level to deliver, as for `events`.

        Returns:
            The listener; its `close()` ends the calls.

        Raises:
            InvalidTypeError: The severity is not a number.
            InvalidArgumentError: The severity is not from 0 to 9.
        """
        return EventListener(self.events(severity=severity), callback)

    async def download_event_metadata(
        self,
        *,
        fetch: Callable[[str], bytes] | None = None,
        cache: MetadataCache | None = USER_CACHE,
        locale: str | None = None,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Mapping[int, EventDefinition]:
        """Download the definitions of the events (COMPONENT_METADATA, MAVLink FTP), unless they are cached.

        Streams and listeners do so by themselves, unless the definitions are on a web server.

        Args:
            fetch: Returns the content of a URL, for components whose metadata is on a web server; called in a
                thread. The URL comes from the component. None: such a file is refused.
            cache: Where files are kept by their CRC; None: nowhere.
            locale: The locale of the texts, such as "de_DE", if they are translated; None: as they are.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.
            progress: Called with the bytes received and the bytes in total.

        Returns:
            The definitions by id, which streams and listeners use from now on.

        Raises:
            RemoteDenied: The component has no metadata of events, or does not give it.
            RemoteTimeout: The component does not answer.
            RemoteProtocolError: The file is damaged, or is not metadata of events.
            RemoteCancelled: The node was closed.
        """
        budget = TimeBudget(timeout, self._clients.host.now)
        access = MetadataAccess(budget, cache, fetch, progress, locale=locale)
        return await self._event_metadata.download(access)

    # Cameras and gimbals

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
        _ = self._clients.get(GimbalMonitor)  # creates the service that stores the gimbals' status messages
        found = await self._clients.host.run_operation(self._clients.command, ListGimbals(timeout=timeout))
        return tuple(self.gimbal_device(each.device_id) for each in found if each.device_id)

    # Setpoints, sticks, channels, and the shell

    def setpoints(self, rate: float = 20.0) -> ControlStream[Setpoint]:
        """Stream setpoints while a block runs, as the offboard and guided modes need them.

        Args:
            rate: Hertz at which the last setpoint is repeated.

        Returns:
            An async context manager with `set(setpoint)`.
        """
        streamer = SetpointStreamer(self._host.address, self.address, rate)
        return ControlStream(self._host, streamer, streamer)

    def manual_control(self, rate: float = 20.0) -> ControlStream[ManualInput]:
        """Stream stick positions while a block runs (MANUAL_CONTROL).

        Args:
            rate: Hertz at which the last stick positions are repeated.

        Returns:
            An async context manager with `set(input)`.
        """
        sender = ManualControlSender(self._host.address, self.address, rate)
        return ControlStream(self._host, sender, sender)

    def override_channels(self, rate: float = 20.0) -> ControlStream[ChannelOverride]:
        """Override radio control channels while a block runs (RC_CHANNELS_OVERRIDE).

        Args:
            rate: Hertz at which the last values are repeated.

        Returns:
            An async context manager with `set(override)`.
        """
        sender = OverrideSender(self._host.address, self.address, rate)
        return ControlStream(self._host, sender, sender)

    def shell(self) -> Shell:
        """Open a shell on the component while a block runs (SERIAL_CONTROL).

        Returns:
            An async context manager; write lines to it, iterate over its output.
        """
        return Shell(self._host, self.address)

    # Signing and time

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
        await setup_signing(self._clients, key, name, timeout)

    @property
    def clock(self) -> TimesyncClient:
        """The client that follows the component's clock (TIMESYNC), from the first use on; see `estimate`."""
        return self._clients.get(TimesyncClient)

    def __repr__(self) -> str:
        return f"<RemoteComponent {self.address}>"
