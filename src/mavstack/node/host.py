"""The host of a node's parts: engine, driver and dispatch behind one narrow interface.

A `Node` creates one host and hands it to its remote components and their parts (`params`, `mission`, `ftp`
…). The parts therefore need no import of the node, and the engine and the driver stay out of the public API.
"""

from __future__ import annotations

import asyncio
from operator import attrgetter
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack._core import Intake
from mavstack.errors import InvalidStateError
from mavstack.node.dispatch import EventDispatch, PacketDispatch
from mavstack.node.message_fields import BOOT_FIELDS, HEADING_FIELDS, POSITION_FIELDS
from mavstack.node.silence_timer import SilenceTimer
from mavstack.security.roles import Role, command_ids
from mavstack.services.command import CommandOperation
from mavstack.services.command_names import command_of_dialect

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.errors import SystemIdConflictError
    from mavstack.node.component import RemoteComponent
    from mavstack.node.dispatch import Listener
    from mavstack.node.driver import Driver
    from mavstack.node.engine import Engine
    from mavstack.node.node import Node
    from mavstack.node.subscription import Subscription
    from mavstack.services import Address, Client, Operation, Service
    from mavstack.services.heartbeat import ComponentInfo, Discovery
    from mavstack.wire import Packet

AnyService = TypeVar("AnyService", bound="Service")
AnyMessage = TypeVar("AnyMessage", bound="Message")
Result = TypeVar("Result")

#: Seconds between two checks whether exactly one vehicle uses the address of an operation.
EXAMINATION_INTERVAL = 0.05
#: Seconds in which all vehicles with one address have sent a heartbeat.
FIRST_HEARTBEATS = 1.2


def acts_soon(operation: Operation[Any]) -> bool:
    """Return whether an operation begins with a command that acts."""
    return isinstance(operation, CommandOperation) and (
        operation.command.command not in command_ids(Role.OBSERVE)
    )


class NodeHost:
    """The engine of a node, its driver while the node is open, and the dispatch of packets and events."""

    def __init__(self, engine: Engine, discovery: Discovery) -> None:
        self.engine = engine
        self.discovery = discovery
        self.packet_dispatch = PacketDispatch()
        #: The native input: it keeps the latest packets, and its thread reads links while the node is open.
        self.intake = Intake(engine.dialect, BOOT_FIELDS, POSITION_FIELDS, HEADING_FIELDS)
        self.event_dispatch = EventDispatch()
        #: Called with all bytes that are written to channels.
        self.sent_listeners: list[Callable[[bytes], None]] = []
        #: Returns whether links may have several peers, so that a vehicle may be received on a further
        #: channel.
        self.may_have_several_peers: Callable[[], bool] = lambda: False
        #: The remote components that were requested so far.
        self.remotes: dict[Address, RemoteComponent] = {}
        #: Seconds for which datagrams may wait for further ones; see the argument `input_interval` of `Node`.
        self.input_interval = 0.0
        #: The driver that runs the engine; None while the node is closed.
        self.open_driver: Driver | None = None

    @property
    def address(self) -> Address:
        """The address of the local component."""
        return self.engine.local

    def named_command(self, command: int) -> int:
        """Return a command as a member of the MAV_CMD of the node's dialect, so that errors name it."""
        return command_of_dialect(command, self.engine.dialect)

    @property
    def components(self) -> dict[Address, ComponentInfo]:
        """Every component discovered so far, by address."""
        return self.discovery.components

    @property
    def is_open(self) -> bool:
        """True while the node is open."""
        return self.open_driver is not None

    @property
    def driver(self) -> Driver:
        """The driver that runs the engine; raises `InvalidStateError` while the node is closed."""
        if self.open_driver is None:
            raise InvalidStateError("the node is not open: use `async with` or `await node.open()`")
        return self.open_driver

    def now(self) -> float:
        """Return the time of services: Unix seconds that never decrease."""
        return self.driver.now()

    def serve(self, service: AnyService) -> AnyService:
        """Run a service, now or as soon as the node opens."""
        self.engine.add(service)
        self.wake(service)
        return service

    def remove(self, service: Service) -> None:
        """Stop running a service; its unsent messages are discarded."""
        self.engine.remove(service)

    def wake(self, service: Service) -> None:
        """Process a service whose methods were called: its messages, events and timer."""
        self.engine.touch(service)
        if self.open_driver is not None:
            self.open_driver.step()

    def send(self, message: Message, target: Address | None = None, *, at_once: bool = False) -> None:
        """Send a message to a target, or to the address in its target fields.

        Args:
            message: The message.
            target: The target; None: the address in the message.
            at_once: Write it now; False: at the end of this turn of the event loop, with the others.
        """
        driver, engine = self.driver, self.engine
        if at_once and engine.idle:  # nothing is to be sent before it, no service is touched by it
            driver.write(engine.encode(message, driver.now(), target))
            return
        engine.send(message, driver.now(), target)
        if at_once:
            driver.step()
        else:
            driver.step_soon()

    def receive_packet(self, packet: Packet) -> None:
        """Keep a packet as the latest of its message, and deliver it."""
        self.intake.keep(packet, self.now())
        self.packet_dispatch.deliver(packet)

    async def run_operation(
        self,
        client: Client,
        operation: Operation[Result],
        progress: Callable[[int, int], None] | None = None,
    ) -> Result:
        """Start an operation and wait for its result, after it is clear which vehicle it is for."""
        await self.wait_until_examined(client.target, acting=acts_soon(operation))
        client.begin(operation, self.driver.now())
        return await self.finish(client, operation, progress)

    async def wait_until_examined(self, target: Address, *, acting: bool) -> None:
        """Wait until it is clear whether several vehicles use the address of a target.

        That takes a moment after the address came on another channel. A target that was found a moment ago,
        on links that may have several peers, may be heard on another channel with its next heartbeat; only
        an operation that acts waits for that.
        """
        while self.open_driver is not None and self._is_in_doubt(target, acting):  # noqa: ASYNC110
            await asyncio.sleep(EXAMINATION_INTERVAL)

    def _is_in_doubt(self, target: Address, acting: bool) -> bool:
        now = self.now()
        if not self.discovery.is_examined(target, now):
            return True
        info = self.components.get(target)
        is_new = info is not None and now - info.first_seen < FIRST_HEARTBEATS
        return acting and is_new and self.may_have_several_peers()

    @property
    def refusal_of(self) -> Callable[[Address, str], SystemIdConflictError | None]:
        """Returns why an operation may not act on a target now; None if it may."""
        return self.engine.senders.refusal_of

    async def finish(
        self,
        client: Client,
        operation: Operation[Result],
        progress: Callable[[int, int], None] | None = None,
    ) -> Result:
        """Wait for the result of an operation that was just started."""
        with SilenceTimer(client, operation, self.components, self.now, lambda: self.wake(client)):
            return await self.driver.finish(client, operation, progress)

    def add_listener(
        self,
        kind: type[AnyMessage] | tuple[type[AnyMessage], ...],
        callback: Callable[[AnyMessage], None],
        source: Address,
    ) -> Listener:
        """Call a function with each message of these classes from a source."""

        def deliver(packet: Packet) -> None:
            callback(packet.message)

        kinds = kind if isinstance(kind, tuple) else (kind,)
        return self.packet_dispatch.add(kinds, source, deliver)

    def events(self, *kinds: type[Any], of: Service | None = None, queue: int) -> Subscription[Any]:
        """Subscribe to events by class."""
        return self.event_dispatch.subscribe(kinds, of, queue=queue)

    def stream(
        self, kinds: tuple[type[Message], ...], source: Address, *, queue: int, keep_all: bool
    ) -> Subscription[Any]:
        """Subscribe to messages of these classes (none: all that the dialect defines) from a source."""
        dispatch = self.packet_dispatch
        if not kinds:
            return dispatch.subscribe_to_all(source, queue=queue, keep_all=keep_all)
        return dispatch.subscribe(kinds, source, attrgetter("message"), queue=queue, keep_all=keep_all)


def host_of(node: Node) -> NodeHost:
    """Return the host of a node."""
    return node._host  # noqa: SLF001 (for the functions that a node binds as its methods)
