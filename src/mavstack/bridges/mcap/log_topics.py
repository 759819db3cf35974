"""The topics of a vehicle out of its packets, as in a log, without connection and clock."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from mavstack.bridges.core.mapper import Mapper
from mavstack.bridges.core.row import Source
from mavstack.bridges.core.rows.packets import packet_values
from mavstack.bridges.core.table import PUBLICATIONS
from mavstack.bridges.core.topic import Topic
from mavstack.bridges.core.vehicle_bridge import RADIO_SYSTEM
from mavstack.bridges.core.view import VehicleView
from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.statustext import StatusText, StatustextReceiver

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.bridges.core.names import VehicleNames
    from mavstack.dialects import Message
    from mavstack.wire import Packet

#: Called with a topic, the CDR bytes of a sample, the sample's time and the packet's time as Unix
#: nanoseconds.
Write: TypeAlias = "Callable[[Topic, bytes, int, int], object]"
#: Nanoseconds between two samples of periodic rows, which no message triggers.
_TICK: Final = 1_000_000_000
_PACKETS: Final = "mavlink_source"
_NO_AUTOPILOT: Final = int(common.MavAutopilot.INVALID)


class LogTopics:
    """The topics of one vehicle.

    Args:
        system: The system id.
        names: The names of its topics.
        write: Called with each sample.
        packets: Raw packets are a topic too; a tlog holds them better.
    """

    def __init__(self, system: int, names: VehicleNames, write: Write, *, packets: bool = False) -> None:
        self._system = system
        self._component: int | None = None
        self._latest: dict[type[Message], Message] = {}
        self._view = VehicleView(self._last, system, names.frames())
        self._packets = packets
        self._now = 0
        self._tick_at = 0
        topics = [self._topic(row, names, write) for row in PUBLICATIONS if packets or row.name != _PACKETS]
        self._mapper = Mapper(self._view, topics)
        self._by_message: dict[type[Message], tuple[Topic, ...]] = {}
        self._texts = StatustextReceiver(Address(0, 0))

    def receive(self, packet: Packet, time: int) -> None:
        """Write the samples of a packet.

        Args:
            packet: A packet of the vehicle, or of its radio.
            time: When it was received, as Unix nanoseconds.
        """
        self._now = time
        message = packet.message
        if isinstance(message, common.Heartbeat) and message.autopilot != _NO_AUTOPILOT:
            self._component = packet.component
        is_own = packet.system == self._system
        if is_own and packet.component == self._component:
            self._latest[type(message)] = message
        self._mapper.receive(message, time, self._wanted(packet, message, is_own=is_own))
        if is_own:
            self._add_others(packet, time)

    def _wanted(self, packet: Packet, message: Any, *, is_own: bool) -> list[Topic]:
        """Return the topics that a packet makes, by the component that sent it."""
        found = self._by_message.get(type(message))
        if found is None:
            found = self._by_message[type(message)] = self._mapper.topics_of(type(message))
        allowed = {Source.RADIO} if is_own or packet.system == RADIO_SYSTEM else set()
        if is_own:
            allowed.add(Source.SYSTEM)
            if packet.component == self._component:
                allowed.add(Source.AUTOPILOT)
        return [topic for topic in found if topic.row.source in allowed]

    def _add_others(self, packet: Packet, time: int) -> None:
        """Write the values that no row converts: texts, rows of time, raw packets."""
        self._texts.receive(packet, time / 1e9)
        self._texts.handle_timeout(time / 1e9)
        for event in self._texts.events():
            if isinstance(event, StatusText):
                self._mapper.publish("statustext/recv", (int(event.severity), event.text), time)
        if self._packets:
            self._mapper.publish(_PACKETS, packet_values(packet), time)
        if time >= self._tick_at and self._component is not None:
            self._tick_at = time + _TICK
            self._mapper.tick(time)

    def _last(self, message: Any) -> Any:
        return self._latest.get(message)

    def _topic(self, row: Any, names: VehicleNames, write: Write) -> Topic:
        topic = Topic(row, names.full(row.name), names.frames().name_of(row.frame), node=names.node())
        topic.add_receiver(partial(self._write, write, topic))
        return topic

    def _write(self, write: Write, topic: Topic, payload: bytes, stamp: int) -> None:
        write(topic, payload, stamp, self._now)
