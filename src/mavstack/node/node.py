"""A node: a program as a MAVLink component, with an address, links, and services.

    async with Node("udpin://0.0.0.0:14550") as node:
        autopilot = await node.wait_for_autopilot()
        await autopilot.command(common.MavCmd.COMPONENT_ARM_DISARM, 1)
        async for message in node.stream(common.Attitude): ...

The class serves ground stations, companion computers and payloads alike: `system`, `component` and `type` say
what the program is, and `serve`, `publish` and `on_command` add the services that the program offers. Nothing
is global: dialect, version, address and keys belong to the node. A slow subscriber loses messages of its own
queue and delays nothing else.
"""

from __future__ import annotations

import asyncio
from contextlib import AsyncExitStack
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import Dialect, Message, common
from mavstack.errors import InvalidArgumentError, InvalidStateError, RemoteTimeout
from mavstack.links import ChannelClosed, ChannelOpened, Link, open_link
from mavstack.links.settings import VERSIONS
from mavstack.node import messaging, sender_choice, serving
from mavstack.node.api_object import ReadOnly
from mavstack.node.command_handlers import CommandHandlers
from mavstack.node.component import RemoteComponent
from mavstack.node.diagnostics import describe_traffic
from mavstack.node.driver import Driver
from mavstack.node.engine import Engine
from mavstack.node.host import NodeHost
from mavstack.node.key_change import trusted_channels
from mavstack.node.keys import Keys
from mavstack.node.link_settings import heartbeat_interval, link_keys, local_address
from mavstack.node.log_events import log_event
from mavstack.node.parts import Part
from mavstack.node.version_query import VersionQueries
from mavstack.services import DEFAULT_WAIT_TIMEOUT, Address
from mavstack.services.heartbeat import (
    ComponentChanged,
    ComponentFound,
    ComponentRebooted,
    ComponentReturned,
    Discovery,
    HeartbeatSender,
)
from mavstack.services.heartbeat.sender import DEFAULT_INTERVAL
from mavstack.services.message_request import MessageServer
from mavstack.services.ping import PingServer
from mavstack.services.rtk import CorrectionSender
from mavstack.services.signing_setup import KeyEvent
from mavstack.services.statustext import StatustextReceiver, StatustextSender
from mavstack.services.timesync import TimesyncServer

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self

    from mavstack._core import HasCoreDialect
    from mavstack.links import Channel
    from mavstack.links.settings import Version
    from mavstack.node.channel_state import ChannelState
    from mavstack.security import SigningKey, TimestampStore
    from mavstack.services import Client, Operation, Service
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.services.signing_setup import SigningRequest

AnyService = TypeVar("AnyService", bound="Service")
AnyHandler = TypeVar("AnyHandler", bound="Callable[..., Any]")
Result = TypeVar("Result")


class Node(ReadOnly):
    """The local MAVLink component; open it with `async with`, or with `open()` and `close()`.

    Args:
        links: URLs such as "udpin://0.0.0.0:14550", or links from `mavstack.links`.
        system: The node's system id, 1 to 255.
        component: The node's component id, 1 to 255.
        type: The MAV_TYPE in the node's HEARTBEAT.
        autopilot: The MAV_AUTOPILOT in the node's HEARTBEAT; INVALID for everything but flight controllers.
        dialect: The dialect of the messages; None: "all".
        version: The MAVLink version of sent packets, 1 or 2; both are received. "auto": 1 on the channels of
            peers that have only been heard speaking version 1, 2 on all others.
        signing: The key that new channels sign with; None: unsigned.
        timestamps: The store of the signing timestamp between two runs of the program; None: not stored.
        heartbeat: Send HEARTBEAT.
        heartbeat_rate: Heartbeats per second; 0: none.
        channel: The only channel whose packets count, by its name or its remote address, such as
            "192.168.1.20:14550" or "/dev/ttyACM0", where several vehicles use one system id; None: all.
        input_interval: Seconds that datagrams may wait for others while many arrive and no answer is awaited,
            0 to 1: fewer wake-ups of the program; 0: none waits.

    The options `id`, `mavlink`, `signing_key` and `heartbeat_rate` of a link's URL win over the arguments.

    Raises:
        InvalidArgumentError: `system` or `component` is not in 1 to 255, `version`, `heartbeat_rate` or
            `input_interval` is invalid, or the URLs contradict each other.
        LinkURLError: A URL is invalid.
        SigningError: The key that a URL names cannot be read.
    """

    links: list[Link]

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
    corrections = Part(
        CorrectionSender,
        "The sender of corrections for satellite navigation (GPS_RTCM_DATA), once over each link.",
        lambda node: node.serve(serving.correction_sender(node)),
    )
    _statustext_sender = Part(
        StatustextSender,
        "The sender of status texts.",
        lambda node: node.serve(StatustextSender(node.address)),
    )

    def __init__(
        self,
        *links: str | Link,
        system: int = 255,
        component: int = common.MavComponent.MISSIONPLANNER,
        type: int = common.MavType.GCS,  # noqa: A002 (HEARTBEAT's name for it)
        autopilot: int = common.MavAutopilot.INVALID,
        dialect: HasCoreDialect | None = None,
        version: Version = 2,
        signing: SigningKey | None = None,
        timestamps: TimestampStore | None = None,
        heartbeat: bool = True,
        heartbeat_rate: float = 1.0,
        channel: str | None = None,
        input_interval: float = 0.0,
    ) -> None:
        if version not in VERSIONS.values():
            raise InvalidArgumentError(f"version must be 1, 2 or 'auto', got {version!r}")
        if not 0 <= input_interval <= 1:
            raise InvalidArgumentError(f"input_interval must be 0 to 1 s, got {input_interval}")
        #: The node's links, in the order in which they were given.
        self.links: list[Link] = [open_link(link) if isinstance(link, str) else link for link in links]
        local = local_address(self.links, system, int(component))
        interval = heartbeat_interval(self.links, heartbeat_rate if heartbeat else 0.0)
        engine = Engine(local, dialect or Dialect.load("all"))
        self._host = NodeHost(
            engine,
            Discovery(
                local,
                is_echo=engine.is_echo,
                channel_name=engine.arrival_channel,
                is_verified=engine.routes.is_verified,
                is_excluded=engine.arrived_excluded,
                asks=interval is not None,
            ),
        )
        self._host.input_interval = input_interval
        sender_choice.follow_conflicts(self._host, self.links, channel)
        self._heartbeat = HeartbeatSender(local, type, autopilot, interval=interval or DEFAULT_INTERVAL)
        #: The services of every node: they receive status texts, and answer PING and TIMESYNC.
        self._common_services = (StatustextReceiver(local), PingServer(local), TimesyncServer(local))
        self._version = version
        self._keys = Keys(engine, signing, timestamps, link_keys(self.links))
        self._version_queries = VersionQueries(engine.routes, self.component)
        self._sends_heartbeat = interval is not None

    @property
    def address(self) -> Address:
        """The node's own system and component id."""
        return self._host.address

    @property
    def dialect(self) -> HasCoreDialect:
        """The dialect of the node's messages."""
        return self._host.engine.dialect

    @property
    def components(self) -> dict[Address, ComponentInfo]:
        """Every component discovered so far, by address."""
        return self._host.components

    @property
    def is_open(self) -> bool:
        """True while the node is open."""
        return self._host.is_open

    async def open(self) -> Self:
        """Open the links and start the services. Does nothing if the node is open.

        Returns:
            The node.

        Raises:
            LinkError: A link cannot be opened; the others are closed again.
            SigningError: The stored signing timestamp cannot be read.
        """
        if self._host.is_open:
            return self
        engine = self._host.engine
        driver = Driver(
            engine,
            on_packet=self._host.receive_packet,
            on_event=self._on_event,
            on_channel=self._keys.on_channel_opened,
            sent_listeners=self._host.sent_listeners,
            on_error=self._on_operation_error,
            version=self._version,
            host=self._host,
        )
        self._keys.open(driver.now())
        self._host.open_driver = driver
        for service in (self._host.discovery, *self._common_services):
            engine.add(service)
        if self._sends_heartbeat:
            engine.add(self._heartbeat)
        try:
            for link in self.links:
                await link.open()
                driver.read(link)
        except BaseException:
            await self.close()
            raise
        driver.step()
        return self

    async def close(self) -> None:
        """Cancel running operations on both ends, end all subscriptions and close the links. Idempotent.

        Packets that arrive meanwhile are ignored. A step that fails does not keep the others from being done;
        its error is raised at the end.
        """
        driver, self._host.open_driver = self._host.open_driver, None
        if driver is None:
            return
        driver.stop_receiving()
        async with AsyncExitStack() as steps:  # the last step runs first
            steps.callback(self._host.event_dispatch.end)
            steps.callback(self._host.packet_dispatch.end)
            for link in reversed(self.links):
                steps.push_async_callback(link.close)
            steps.push_async_callback(self._keys.close)
            steps.push_async_callback(driver.stop)
            steps.push_async_callback(self._version_queries.close)
            handlers = Node.commands.made(self)
            if handlers is not None:
                steps.push_async_callback(handlers.stop)

    # Links

    async def add_link(self, link: str | Link) -> Link:
        """Add a link; on an open node the link is opened at once.

        The address and the heartbeats of a node do not change while it is open, so the URL must not name
        others.

        Args:
            link: A URL such as "tcpout://192.168.1.20:5760", or a link.

        Returns:
            The link.

        Raises:
            InvalidArgumentError: The URL gives the node another address, or a rate of heartbeats.
            LinkError: The link cannot be opened.
            LinkURLError: The URL is invalid.
            SigningError: The key that the URL names cannot be read.
        """
        added = open_link(link) if isinstance(link, str) else link
        if local_address([added], *self.address) != self.address:
            raise InvalidArgumentError(f"{added.url.redacted}: the address of the node is {self.address}")
        if added.settings.heartbeat_rate is not None:
            raise InvalidArgumentError(
                f"{added.url.redacted}: heartbeat_rate is only for the links that a node begins with"
            )
        keys = link_keys([added])
        driver = self._host.open_driver
        if driver is not None:
            await added.open()
            if self._host.open_driver is not driver:
                await added.close()
                raise InvalidStateError(f"cannot add {added.url.redacted}: the node was closed meanwhile")
        self._keys.add_links(keys)
        if driver is not None:
            driver.read(added)
        self.links.append(added)
        return added

    async def remove_link(self, link: Link) -> None:
        """Close a link and remove it; components that were reachable over it alone become lost.

        Args:
            link: One of `links`.

        Raises:
            InvalidArgumentError: The node does not have that link.
        """
        if link not in self.links:
            raise InvalidArgumentError(f"the node has no link {link.url.redacted}")
        self.links.remove(link)
        await link.close()
        self._keys.remove_link(link)

    # Remote components

    def component(self, system: int, component: int = common.MavComponent.AUTOPILOT1) -> RemoteComponent:
        """Return a remote component by its address, whether it was discovered or not.

        Args:
            system: The system id.
            component: The component id.

        Returns:
            The component; the same object for the same address.
        """
        address = Address(system, int(component))
        known = self._host.remotes.get(address)
        if known is None:
            known = self._host.remotes[address] = RemoteComponent(self._host, address)
        return known

    async def wait_for_autopilot(
        self, system: int | None = None, *, timeout: float | None = DEFAULT_WAIT_TIMEOUT
    ) -> RemoteComponent:
        """Wait until the heartbeat of an autopilot is received.

        Args:
            system: The system id; None: the first autopilot that is discovered.
            timeout: Seconds to wait; None: for ever.

        Returns:
            The autopilot.

        Raises:
            RemoteTimeout: No autopilot was discovered in time; the text names the traffic received.
        """
        description = "an autopilot" if system is None else f"the autopilot of system {system}"
        return await self.wait_for_component(
            lambda info: info.is_autopilot and system in (None, info.address.system),
            description,
            timeout=timeout,
        )

    async def wait_for_component(
        self,
        predicate: Callable[[ComponentInfo], bool],
        description: str = "a component",
        *,
        timeout: float | None = DEFAULT_WAIT_TIMEOUT,
    ) -> RemoteComponent:
        """Wait until a component is alive for which `predicate` is true.

        Args:
            predicate: Called with the `ComponentInfo` of each component.
            description: The name of the component in the error text.
            timeout: Seconds to wait; None: for ever.

        Returns:
            The first component for which `predicate` is true.

        Raises:
            RemoteTimeout: No such component was discovered in time; the text names the traffic received.
        """
        async with self.events(ComponentFound, ComponentReturned, ComponentChanged) as events:
            try:
                async with asyncio.timeout(timeout):
                    while not (
                        found := [info for info in self.components.values() if info.alive and predicate(info)]
                    ):
                        await anext(events)
                        events.drain()  # check all components once for all events so far
            except (TimeoutError, StopAsyncIteration):
                raise self._wait_error(description, "none", timeout) from None
        return self.component(*found[0].address)

    async def serve_forever(self) -> None:
        """Wait until the task is cancelled: the last call of a program that only serves."""
        await asyncio.get_running_loop().create_future()

    # Services

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

    serve_camera = serving.serve_camera
    serve_gimbal = serving.serve_gimbal
    serve_arm_authorization = serving.serve_arm_authorization
    serve_terrain = serving.serve_terrain

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

    # Messages

    stream = messaging.stream
    packets = messaging.packets
    add_listener = messaging.add_listener
    add_packet_listener = messaging.add_packet_listener
    record = messaging.record
    events = messaging.events
    send = messaging.send
    forward = messaging.forward

    # Several vehicles with one system id

    has_address_conflict = sender_choice.has_address_conflict
    id_conflict = sender_choice.id_conflict
    choose_sender = sender_choice.choose_sender
    check_sender = sender_choice.check_sender
    refuse_conflict = sender_choice.refuse_conflict
    forget_sender = sender_choice.forget_sender
    chosen_sender = sender_choice.chosen_sender

    # Hooks for subclasses

    def _on_event(self, event: object, service: Service | None = None) -> None:
        """Handle an event of a link or a service, then deliver it to subscriptions."""
        log_event(event)
        self._version_queries.on_event(event)
        match event:
            case ChannelOpened() if self._sends_heartbeat:
                self._heartbeat.send_now(self.now())  # a new peer learns of this node at once
                self._host.engine.touch(self._heartbeat)
            case ChannelClosed(channel, reason):
                routes = self._host.engine.routes
                lost = [address for address in self.components if not routes.heard_on(address)]
                self._host.discovery.unreachable(lost, f"its link {channel.name} is closed: {reason}")
                self._host.engine.touch(self._host.discovery)
            case ComponentRebooted(component) if component.address in self._host.remotes:
                self._host.remotes[component.address].clear_cache()
            case KeyEvent():
                self._keys.on_key_event(event, service)
        self._host.event_dispatch.deliver(event, service)

    def _on_operation_error(self, operation: Operation[Any], started_at: float) -> None:
        """Handle the error of an operation that began at `started_at`; a subclass may add details."""

    def _wait_error(self, description: str, found: str, timeout: float | None) -> RemoteTimeout:
        """Return the error of a wait for components that ended without a match."""
        links = ", ".join(str(link.url) for link in self.links) or "no link"
        reason = (
            f"{found} in {timeout:g} s" if timeout is not None and self.is_open else "the node was closed"
        )
        answer = f"{reason}; {describe_traffic(self._host)}"
        return RemoteTimeout(f"waiting for {description} on", links, answer=answer)

    async def __aenter__(self) -> Self:
        return await self.open()

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()
