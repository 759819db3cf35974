"""A node is a program as a MAVLink component: an address, links, and the services that live on them.

    async with Node("udpin://0.0.0.0:14550") as node:
        vehicle = await node.wait_for_autopilot()
        await vehicle.command(common.MavCmd.COMPONENT_ARM_DISARM, 1)
        async for message in node.stream(common.Attitude): ...

The same class is a ground station, a companion computer or a payload: what it is, its `system`,
`component` and `type` say, and what it offers, the services given to `serve`. Nothing is global: dialect,
version, address and keys belong to the node. Everything a subscriber or a handler does not take in time is
dropped for it alone.
"""

from __future__ import annotations

import asyncio
from functools import cached_property
from operator import attrgetter
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import Dialect, Message, common
from mavstack.errors import MavstackError, RemoteTimeout
from mavstack.links import ChannelClosed, ChannelOpened, Link, open_link
from mavstack.node.command_handlers import CommandHandlers
from mavstack.node.dispatch import EventDispatch, PacketDispatch
from mavstack.node.driver import Driver
from mavstack.node.engine import Engine
from mavstack.node.diagnostics import what_was_heard
from mavstack.node.keys import Keys
from mavstack.node.component import RemoteComponent
from mavstack.node.subscription import QUEUE
from mavstack.services import DEFAULT_WAIT_TIMEOUT, Address
from mavstack.services.heartbeat import (
    Beacon,
    ComponentChanged,
    ComponentFound,
    ComponentRebooted,
    ComponentReturned,
    Discovery,
)
from mavstack.services.message_request import MessageServer
from mavstack.services.ping import PingServer
from mavstack.services.signing_setup import KeyEvent
from mavstack.services.statustext import StatustextReceiver, StatustextSender
from mavstack.services.timesync import TimesyncServer

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self

    from mavstack._core import HasCoreDialect
    from mavstack.node.dispatch import Listening
    from mavstack.node.subscription import Subscription
    from mavstack.security import SigningKey, TimestampStore
    from mavstack.services import Client, Operation, Service
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.wire import Packet

AnyMessage = TypeVar("AnyMessage", bound=Message)
AnyEvent = TypeVar("AnyEvent")
AnyService = TypeVar("AnyService", bound="Service")
AnyHandler = TypeVar("AnyHandler", bound="Callable[..., Any]")
Result = TypeVar("Result")


class Node:
    """We, on the network; open it with `async with`, or `await node.open()` and `await node.close()`."""

    def __init__(
        self,
        *links: str | Link,
        system: int = 255,
        component: int = common.MavComponent.MISSIONPLANNER,
        type: int = common.MavType.GCS,  # noqa: A002 (HEARTBEAT's name for it)
        autopilot: int = common.MavAutopilot.INVALID,
        dialect: HasCoreDialect | None = None,
        version: int = 2,
        signing: SigningKey | None = None,
        timestamps: TimestampStore | None = None,
        heartbeat: bool = True,
    ) -> None:
        local = Address(system, int(component))
        if not (0 < local.system < 256 and 0 < local.component < 256):
            raise MavstackError(f"{local} is not an address: system and component are 1 to 255")
        self.engine = Engine(local, dialect or Dialect.load("all"))
        self.beacon = Beacon(local, type, autopilot)
        self.discovery = Discovery(local, is_echo=self.engine.is_echo, where=self.engine.arrived_where)
        self.links = [open_link(link) if isinstance(link, str) else link for link in links]
        #: What every component does: it hears texts, and answers who asks whether and when it is there.
        self._everyones = (StatustextReceiver(local), PingServer(local), TimesyncServer(local))
        self._version = version
        self._keys = Keys(self.engine, signing, timestamps)
        self._sends_heartbeat = heartbeat
        self._packets = PacketDispatch()
        self._events = EventDispatch()
        self._remotes: dict[Address, RemoteComponent] = {}
        self._commands: CommandHandlers | None = None
        self._driver: Driver | None = None

    @property
    def address(self) -> Address:
        """Our system and component id."""
        return self.engine.local

    @property
    def components(self) -> dict[Address, ComponentInfo]:
        """Everyone who was heard, by address."""
        return self.discovery.components

    @property
    def driver(self) -> Driver:
        """What runs the engine; there is one while the node is open."""
        if self._driver is None:
            raise MavstackError("the node is not open: use `async with` or `await node.open()`")
        return self._driver

    @property
    def is_open(self) -> bool:
        """Whether its links are open."""
        return self._driver is not None

    async def open(self) -> Self:
        """Open the links; raises `LinkError` for the first that cannot be."""
        if self._driver is not None:
            return self
        self._keys.open()
        self._driver = driver = Driver(
            self.engine,
            on_packet=self._packets.deliver,
            on_event=self._happened,
            on_channel=self._keys.opened,
            on_error=self._failed,
            version=self._version,
        )
        for service in (self.discovery, *self._everyones):
            self.engine.add(service)
        if self._sends_heartbeat:
            self.engine.add(self.beacon)
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
        """Cancel what has not ended on both sides, and close the links. Closing twice does nothing."""
        driver, self._driver = self._driver, None
        if driver is not None:
            if self._commands is not None:
                await self._commands.stop()
            await driver.stop()
            await self._keys.close()
            for link in self.links:
                await link.close()
            self._packets.end()
            self._events.end()

    # Who is there

    def component(self, system: int, component: int = common.MavComponent.AUTOPILOT1) -> RemoteComponent:
        """Another component, by its address, whether it was heard yet or not."""
        address = Address(system, int(component))
        known = self._remotes.get(address)
        if known is None:
            known = self._remotes[address] = RemoteComponent(self, address)
        return known

    async def wait_for_autopilot(
        self, system: int | None = None, *, timeout: float | None = DEFAULT_WAIT_TIMEOUT
    ) -> RemoteComponent:
        """The first autopilot heard, or that of a system; raises `RemoteTimeout` if there is none in time."""
        what = (
            "an autopilot's heartbeat" if system is None else f"the heartbeat of system {system}'s autopilot"
        )
        return await self.wait_for_component(
            lambda info: info.is_autopilot and system in (None, info.address.system), what, timeout=timeout
        )

    async def wait_for_component(
        self,
        predicate: Callable[[ComponentInfo], bool],
        description: str,
        *,
        timeout: float | None = DEFAULT_WAIT_TIMEOUT,
    ) -> RemoteComponent:
        """The first component alive that `predicate` accepts; `description` names it in the error."""
        async with self.events(ComponentFound, ComponentReturned, ComponentChanged) as events:
            try:
                async with asyncio.timeout(timeout):
                    while not (
                        found := [info for info in self.components.values() if info.alive and predicate(info)]
                    ):
                        await anext(events)
            except (TimeoutError, StopAsyncIteration):
                links = ", ".join(str(link.url) for link in self.links) or "no link"
                answer = f"none in {timeout:g} s; {what_was_heard(self)}"
                raise RemoteTimeout(description, links, answer=answer) from None
        return self.component(*found[0].address)

    # What is heard and said

    def stream(
        self,
        *kinds: type[AnyMessage],
        system: int = 0,
        component: int = 0,
        queue: int = QUEUE,
        keep_all: bool = False,
    ) -> Subscription[AnyMessage]:
        """Messages of these classes, as they come; `system` and `component` choose the sender (0: any)."""
        return self._packets.subscribe(
            kinds, Address(system, component), attrgetter("message"), queue=queue, keep_all=keep_all
        )

    def packets(
        self,
        *kinds: type[Message],
        system: int = 0,
        component: int = 0,
        queue: int = QUEUE,
        keep_all: bool = False,
    ) -> Subscription[Packet]:
        """The same with their headers; without `kinds` every packet, unknown ids too, raw as they are."""
        return self._packets.subscribe(
            kinds, Address(system, component), _as_it_is, queue=queue, keep_all=keep_all
        )

    def add_listener(
        self,
        kind: type[AnyMessage] | tuple[type[AnyMessage], ...],
        callback: Callable[[AnyMessage], None],
        *,
        system: int = 0,
        component: int = 0,
    ) -> Listening:
        """Call a function with each message of a class, or of several, as soon as it is received.

        The callback must return quickly: everything else waits for it. It is called until the result is
        closed, and not for messages that were received while the node was not open.
        """
        kinds = kind if isinstance(kind, tuple) else (kind,)

        def deliver(packet: Packet) -> None:
            callback(packet.message)

        return self._packets.listen(kinds, Address(system, component), deliver)

    def add_packet_listener(
        self,
        kind: type[Message] | tuple[type[Message], ...] | None,
        callback: Callable[[Packet], None],
        *,
        system: int = 0,
        component: int = 0,
    ) -> Listening:
        """Call a function with each packet of a message class, or of several (None: all), as soon as it is received.

        It must be quick: all else waits for it. It is called until the result is closed, and not called for
        what came while the node was not open.
        """
        kinds = () if kind is None else kind if isinstance(kind, tuple) else (kind,)
        return self._packets.listen(kinds, Address(system, component), callback)

    def events(
        self, *kinds: type[AnyEvent], of: Service | None = None, queue: int = QUEUE
    ) -> Subscription[AnyEvent]:
        """Events of these classes (none: all), of links and of services; `of` chooses one service."""
        return self._events.subscribe(kinds, of, queue=queue)

    def send(self, message: Message, target: Address | None = None) -> None:
        """Send a message; where to, its target fields say, unless `target` does."""
        self.engine.send(message, self.driver.now(), target)
        self.driver.step()

    def forward(self, packet: Packet) -> None:
        """Send a packet of somebody else, byte for byte, to where it is addressed; see `Forwarding`."""
        self.engine.forward(packet, self.driver.now())
        self.driver.step()

    # What lives here

    def serve(self, service: AnyService) -> AnyService:
        """Let a service live on this node, from now on or as soon as it opens."""
        self.engine.add(service)
        self.wake(service)
        return service

    def wake(self, service: Service) -> None:
        """Say that a service's method was called, so that what it wants to send goes out."""
        self.engine.touch(service)
        if self._driver is not None:
            self._driver.step()

    def now(self) -> float:
        """The time as services count it: Unix seconds that never go back."""
        return (self._driver or self.driver).now()

    def publish(
        self, message: type[Message], producer: Callable[[float], Message | None], *, interval: float = 0.0
    ) -> None:
        """Send a message every `interval` seconds, at the rate that others ask for, and when it is requested.

        `producer` is called with the time and makes it, or returns None if there is nothing to tell.
        """
        self.message_server.provide(message, producer, interval=interval)
        self.wake(self.message_server)

    def send_statustext(self, text: str, severity: int = common.MavSeverity.INFO) -> None:
        """Say something to the people who watch, by STATUSTEXT; a long text goes in chunks."""
        self._texts.say(text, severity)
        self.wake(self._texts)

    @cached_property
    def message_server(self) -> MessageServer:
        """Sends what `publish` was given."""
        return self.serve(MessageServer(self.address, self.commands.server))

    @cached_property
    def _texts(self) -> StatustextSender:
        return self.serve(StatustextSender(self.address))

    @property
    def commands(self) -> CommandHandlers:
        """What this node does when it is sent a command."""
        if self._commands is None:
            self._commands = CommandHandlers(self)
        return self._commands

    def on_command(self, command: int) -> Callable[[AnyHandler], AnyHandler]:
        """Decorate a function, plain or async, that carries out a command; see `CommandHandlers`."""
        return self.commands.register(command)

    async def run_operation(
        self,
        client: Client,
        operation: Operation[Result],
        progress: Callable[[int, int], None] | None = None,
    ) -> Result:
        """Run an operation of a client that lives here, to its result or its typed error."""
        return await self.driver.perform(client, operation, progress)

    async def serve_forever(self) -> None:
        """Go on until the task is cancelled: what a program that only serves does last."""
        await asyncio.get_running_loop().create_future()

    def _happened(self, event: object, service: Service | None = None) -> None:
        """Do what is to be done about an event, and tell it to all who listen; a subclass may do more."""
        match event:
            case ChannelOpened() if self._sends_heartbeat:
                self.beacon.soon(self.now())  # a new peer need not wait to know us
                self.engine.touch(self.beacon)
            case ChannelClosed(channel, reason):
                lost = [address for address in self.components if not self.engine.routes.heard_on(address)]
                self.discovery.unreachable(lost, f"its link {channel.name} is closed: {reason}")
                self.engine.touch(self.discovery)
            case ComponentRebooted(component) if component.address in self._remotes:
                self._remotes[component.address].clear_cache()
            case KeyEvent():
                self._keys.told(event, service)
        self._events.deliver(event, service)

    def _failed(self, operation: Operation[Any], begun: float) -> None:
        """An operation that was begun then ends with an error; a subclass may add to it what it knows."""

    async def __aenter__(self) -> Self:
        return await self.open()

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()


def _as_it_is(packet: Packet) -> Packet:
    return packet
