"""One vehicle on a bus: its topics, inlets, services and actions, joined with the live vehicle."""

from __future__ import annotations

import asyncio
import logging
import time
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.action_server import ActionServer
from mavstack.bridges.core.endpoints import Inlet, ServiceEndpoint
from mavstack.bridges.core.inbound import Inbound
from mavstack.bridges.core.mapper import Mapper
from mavstack.bridges.core.names import NODE, PARAMETER_NODE, VehicleNames
from mavstack.bridges.core.row import Source
from mavstack.bridges.core.rows.packets import packet_values
from mavstack.bridges.core.services.context import ServiceContext
from mavstack.bridges.core.services.parameters import event_values
from mavstack.bridges.core.services.plans import LISTS, publish_plan, pull_plan
from mavstack.bridges.core.table import ACTIONS, PUBLICATIONS, SERVICES, SUBSCRIPTIONS
from mavstack.bridges.core.topic import Topic
from mavstack.bridges.core.view import VehicleView
from mavstack.dialects import common
from mavstack.errors import MavstackError
from mavstack.services.mission import PlanType

if TYPE_CHECKING:
    from collections.abc import Coroutine

    from mavstack.bridges.core.row import Publication, Service
    from mavstack.bridges.core.sink import Sink
    from mavstack.dialects import Message
    from mavstack.node.dispatch import Listener
    from mavstack.security.roles import Role
    from mavstack.services.parameters import Parameter
    from mavstack.vehicle import Vehicle
    from mavstack.wire import Packet

logger = logging.getLogger("mavstack.bridges")
#: The system id of SiK radios, which report the link with ids that belong to no vehicle.
RADIO_SYSTEM: Final = 51
#: Seconds without a message for a subscribed topic, after which the bridge requests a message.
REQUEST_DELAY: Final = 2.0
#: Rate in hertz of the messages that the vehicle sends only on request.
REQUEST_RATE: Final = 5.0
_PACKETS: Final = "mavlink_source"
_TICK: Final = 1.0


class VehicleBridge:
    """The endpoints of one vehicle.

    Args:
        vehicle: The vehicle.
        names: The names of its endpoints.
        role: The role of the buses: which requests are passed to the vehicle.
    """

    def __init__(self, vehicle: Vehicle, names: VehicleNames, role: Role) -> None:
        self.vehicle = vehicle
        self.names = names
        self.role = role
        self.view = VehicleView(vehicle.latest, vehicle.system, names.frames())
        topics = [self._topic(row) for row in PUBLICATIONS]
        self.mapper = Mapper(self.view, topics)
        self._inbound = Inbound(vehicle.address, self.view, boot=time.time_ns())
        self._context = ServiceContext(self.publish)
        self.inlets = [self._inlet(row) for row in SUBSCRIPTIONS if row.role <= role]
        self.services = [self._service(row) for row in SERVICES]
        self.actions = [
            ActionServer(
                row,
                names.full(row.name),
                vehicle,
                time.time_ns,
                allowed=row.role <= role,
                reject=self._reject,
                node=names.node(),
            )
            for row in ACTIONS
        ]
        self._listeners: dict[type[Message] | None, tuple[Listener, ...]] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._clock: Any = None

    @property
    def topics(self) -> list[Topic]:
        """All topics from the vehicle, those of actions included."""
        return [
            *self.mapper.topics.values(),
            *(topic for action in self.actions for topic in (action.feedback, action.status)),
        ]

    async def attach(self, sink: Sink) -> None:
        """Offer all endpoints to a sink, one in each turn of the event loop: some take milliseconds."""
        sink.add_node(self.names.namespace, NODE)
        sink.add_node(self.names.namespace, PARAMETER_NODE)
        for topic in self.topics:
            sink.add_topic(topic)
            await asyncio.sleep(0)
        for service in (*self.services, *(each for action in self.actions for each in action.services)):
            sink.add_service(service)
            await asyncio.sleep(0)
        for inlet in self.inlets:
            sink.add_inlet(inlet)
            await asyncio.sleep(0)

    def open(self) -> None:
        """Follow the vehicle."""
        self._clock = self.vehicle.component.clock
        self._start(self._run_ticks())
        self._start(self._follow_parameters())
        for source in self.mapper.sources():
            self._listen(source)
        self._listen_to_packets(active=self.mapper.topics[_PACKETS].active)
        heartbeat = self.vehicle.latest(common.Heartbeat)
        if heartbeat is not None:
            self.mapper.receive(heartbeat, time.time_ns(), self.mapper.topics_of(common.Heartbeat))

    async def close(self) -> None:
        """Follow the vehicle no more, and end its actions."""
        for listeners in self._listeners.values():
            for listener in listeners:
                listener.close()
        self._listeners.clear()
        for action in self.actions:
            await action.close()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def publish(self, name: str, values: Any) -> None:
        """Publish a sample of a row that other parts make."""
        self.mapper.publish(name, values, time.time_ns())

    def receive_status_text(self, severity: int, text: str) -> None:
        """Publish a status text of the vehicle."""
        self.publish("statustext/recv", (severity, text))

    def set_connected(self, *, connected: bool) -> None:
        """Publish that the vehicle was lost or returned."""
        self.view.connected = connected
        if not connected:
            self.publish("state", (False, False, False, False, "", 0))

    # Endpoints

    def _topic(self, row: Publication) -> Topic:
        frame = self.names.frames().name_of(row.frame)
        return Topic(row, self.names.full(row.name), frame, self._on_changed, self.names.node())

    def _inlet(self, row: Any) -> Inlet:
        send = self.vehicle.connection.send
        inlet = Inlet(row, self.names.full(row.name), self._inbound, send, time.time_ns, reject=self._reject)
        inlet.node = self.names.node()
        return inlet

    def _service(self, row: Service) -> ServiceEndpoint:
        async def handle(request: dict[str, Any]) -> dict[str, Any]:
            return await row.handle(self.vehicle, request, self._context)

        node = self.names.node(PARAMETER_NODE if row.type.startswith("rcl_interfaces/") else NODE)
        name, allowed = self.names.full(row.name), row.role <= self.role
        return ServiceEndpoint(name, row.type, handle, allowed=allowed, reject=self._reject, node=node)

    def _reject(self, text: str) -> None:
        logger.warning("%s", text)
        self.view.reason = text
        self.publish("reason", (text,))

    # Messages

    def _on_changed(self, topic: Topic) -> None:
        """Follow the messages of a topic that got its first receiver, or lost its last one."""
        if self._clock is None:
            return
        wanted = self.mapper.sources()
        if topic.row.name == _PACKETS:
            self._listen_to_packets(active=topic.active)
        for source in topic.row.sources:
            self._listen(source) if source in wanted else self._unlisten(source)
        if topic.active:
            self._start(self._fill(topic))

    def _listen(self, source: type[Message]) -> None:
        self._unlisten(source)
        topics = self.mapper.topics_of(source)
        groups: dict[Source, tuple[Topic, ...]] = {}
        for kind in Source:
            if group := tuple(topic for topic in topics if topic.row.source is kind):
                groups[kind] = group
        self._listeners[source] = tuple(self._listener(source, kind, group) for kind, group in groups.items())

    def _listener(self, source: type[Message], kind: Source, topics: tuple[Topic, ...]) -> Listener:
        receive = self.mapper.receive

        def deliver(packet: Packet) -> None:
            receive(packet.message, time.time_ns(), topics)

        system, component = self.vehicle.address
        node = self.vehicle.connection
        if kind is Source.RADIO:
            own = (system, RADIO_SYSTEM)
            return node.add_packet_listener(
                source, lambda packet: deliver(packet) if packet.system in own else None
            )
        any_component = kind is Source.SYSTEM
        return node.add_packet_listener(
            source, deliver, system=system, component=0 if any_component else component
        )

    def _unlisten(self, source: type[Message]) -> None:
        for listener in self._listeners.pop(source, ()):
            listener.close()

    def _listen_to_packets(self, *, active: bool) -> None:
        for listener in self._listeners.pop(None, ()):
            listener.close()
        if active:
            node, system = self.vehicle.connection, self.vehicle.system
            self._listeners[None] = (node.add_packet_listener(None, self._on_packet, system=system),)

    def _on_packet(self, packet: Packet) -> None:
        self.publish(_PACKETS, packet_values(packet))

    async def _fill(self, topic: Topic) -> None:
        """Give a new subscriber what the vehicle does not send by itself: a plan, or a message."""
        plans = {name: kind for kind, name in LISTS.items()}
        if topic.row.name in plans:
            if plans[topic.row.name] not in self._context.plans:
                await pull_plan(self.vehicle, plans[topic.row.name], self._context)
            return
        if not topic.row.sources:
            return
        before = topic.published
        await asyncio.sleep(REQUEST_DELAY)
        if topic.published == before and topic.active and not topic.qos.latched:
            await self.vehicle.telemetry.ensure(topic.row.sources[0], REQUEST_RATE)

    # Tasks

    def _start(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.get_running_loop().create_task(_without_errors(work))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _run_ticks(self) -> None:
        """Each second: periodic rows, the clock, the progress of the mission."""
        current = -1
        while True:
            await asyncio.sleep(_TICK)
            self._update_clock()
            self.mapper.tick(time.time_ns())
            progress = self.vehicle.mission.progress
            plan = self._context.plans.get(PlanType.MISSION)
            if progress is not None and plan is not None and progress.seq != current:
                current = progress.seq
                publish_plan(self.vehicle, PlanType.MISSION, plan, self._context)

    def _update_clock(self) -> None:
        estimate = self._clock.estimate
        if estimate is None:
            return
        offset = round(estimate.offset * 1e9)
        self.view.clock.timesync_offset = offset
        now = time.time_ns()
        remote = max(now + offset, 0)
        self.publish("timesync_status", (remote, offset, offset, estimate.round_trip * 1e3))

    async def _follow_parameters(self) -> None:
        async with self.vehicle.params.changes() as changes:
            async for change in changes:
                self._publish_parameter(change.parameter)

    def _publish_parameter(self, parameter: Parameter) -> None:
        self.publish("param/event", event_values(parameter, len(self.vehicle.params.cached)))


async def _without_errors(work: Coroutine[Any, Any, None]) -> None:
    """Run a task of a bridge; its errors are logged."""
    try:
        await work
    except MavstackError as error:
        logger.info("%s", error)
    except asyncio.CancelledError:
        raise
    except Exception:
        logger.exception("a task of the bridge failed")
