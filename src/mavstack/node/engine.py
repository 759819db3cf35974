"""The engine of a node, without sockets and clock: channels, routes, pacing and services.

    engine.receive(channel, data, now)    bytes in; returns the packets, which the services have handled
    engine.data_to_send(now)              (channel, bytes) to write, in order
    engine.events()                       (service, event), in order
    engine.next_timeout()                 when to call `engine.handle_timeout(now)`

The asyncio driver runs an engine over links; tests run several over a simulated network in virtual time: the
routing, pacing and services are the same in both. A packet is handled by the services that handle its message
id, if it is addressed to their component or to all. Only touched services and those whose timer is due run.

If a function of the program that a service calls (a handler, a producer, a policy) raises, `on_failure` is
called, the service's timer is suspended for a moment, and all others continue; its default raises.
"""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import common
from mavstack.errors import EncodeError, SigningError
from mavstack.node.channel_state import ChannelState, unique_name
from mavstack.node.chosen_senders import ChosenSenders
from mavstack.node.duplicates import Duplicates
from mavstack.node.key_change import apply_key_event, carries_key
from mavstack.node.key_channels import KeyChannels
from mavstack.node.own_heartbeats import OwnHeartbeats
from mavstack.node.pacing import is_radio
from mavstack.node.routes import Routes
from mavstack.node.service_index import ServiceIndex
from mavstack.node.service_timers import ServiceTimers
from mavstack.node.signing_states import SigningStates
from mavstack.security import carries_signing_key
from mavstack.services import (
    Address,
    Client,
    Event,
    Outgoing,
    Priority,
    Service,
    earliest,
    message_ids,
    target_of,
)
from mavstack.services.signing_setup import KeyEvent, KeySettled

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from mavstack._core import HasCoreDialect
    from mavstack.dialects import Message
    from mavstack.links.settings import Version
    from mavstack.wire import Packet, Signing

AnyService = TypeVar("AnyService", bound=Service)

#: Seconds for which the timer of a service is suspended after an error, which avoids a busy loop.
FAILURE_INTERVAL = 0.05

_RADIO_STATUS = next(iter(message_ids(common.RadioStatus)))


class Engine:
    """The channels and services of one local component, and the routing and pacing between them."""

    def __init__(self, local: Address, dialect: HasCoreDialect = common) -> None:
        self.local = local
        self.dialect = dialect
        self.routes: Routes[ChannelState] = Routes()
        self.duplicates: Duplicates[ChannelState] = Duplicates()
        self.channels: list[ChannelState] = []
        #: The chosen sender of each system id that several vehicles use.
        self.senders = ChosenSenders(self.channels)
        #: Finds the channels to a target, and the channels over which a signing key may be sent.
        self.key_channels = KeyChannels(self.routes, self.channels, self.senders)
        #: Called with the name of a channel that was closed.
        self.on_channel_closed: Callable[[str], None] = lambda name: None
        #: Called with a signed packet of a verified address on a channel without a key; may set its key.
        self.adopt_key: Callable[[ChannelState, Packet, float], bool] = lambda channel, packet, now: False
        #: The channel of the packet that is handled now; None if no packet is handled.
        self.arrived_on: ChannelState | None = None
        self._heartbeats = OwnHeartbeats(dialect)
        #: Returns whether a packet is a heartbeat of this node that a loop of links returned.
        self.is_echo = self._heartbeats.is_echo
        self.signing_states = SigningStates()
        self._closed_clock = 0
        self._link_ids = count()
        #: Called with each exception raised by a service; see the module's docstring.
        self.on_failure: Callable[[Service, Exception], None] = _raise
        self._services: dict[Service, None] = {}
        self.service_index = ServiceIndex()
        self._touched: dict[Service, None] = {}
        self._to_send: list[tuple[ChannelState, bytes]] = []
        self._events: list[tuple[Service, Event]] = []
        self._timers = ServiceTimers()
        self._blocked: dict[Service, float] = {}
        self._failed: dict[Service, None] = {}

    # Channels

    def open_channel(
        self,
        name: str,
        *,
        version: Version = 2,
        signing: Signing | None = None,
        bandwidth: float | None = None,
        half_duplex: bool = False,
        bulk_rate: float | None = None,
    ) -> ChannelState:
        """Open a channel to a new peer.

        `bandwidth` in bytes per second, None: not known; with `half_duplex` both directions share it.
        `bulk_rate` limits bulk packets per second where the bandwidth is not known.
        """
        channel = ChannelState(
            unique_name(name, self.channels),
            self.dialect,
            version=version,
            signing=signing,
            bandwidth=bandwidth,
            half_duplex=half_duplex,
            bulk_rate=bulk_rate,
        )
        channel.link_id = next(self._link_ids) % 256
        self.channels.append(channel)
        self._touched.update(self._services)
        return channel

    def close_channel(self, channel: ChannelState) -> None:
        """Close the channel of a peer that is gone."""
        self.channels.remove(channel)
        self._closed_clock = max(self._closed_clock, channel.clock)
        self.routes.remove_channel(channel)
        self._to_send = [item for item in self._to_send if item[0] is not channel]
        self.senders.channel_closed(channel)
        self.on_channel_closed(channel.name)

    @property
    def signing_clock(self) -> int:
        """The newest signing timestamp of all channels, closed ones included."""
        return max([self._closed_clock, *(channel.clock for channel in self.channels)])

    # Services

    def arrival_channel(self) -> str:
        """Return the name of the channel of the packet that is being handled."""
        return self.arrived_on.name if self.arrived_on is not None else ""

    def arrived_excluded(self, system: int) -> bool:
        """Return whether another channel than that of the handled packet was chosen for a system."""
        senders, channel = self.senders, self.arrived_on
        return senders.is_limited and channel is not None and senders.excludes(system, channel)

    def arrived_elsewhere(self, target: Address) -> bool:
        """Return whether the handled packet came over another channel than the one named for a key."""
        return self.key_channels.is_other(target, self.arrived_on)

    def add(self, service: AnyService) -> AnyService:
        """Run a service."""
        if service not in self._services:
            self._services[service] = None
            self.service_index.update(service)
            self.touch(service)
            if isinstance(service, Client):
                service.refusal = self.senders.refusal
        return service

    def remove(self, service: Service) -> None:
        """Stop running a service; its unsent messages are discarded."""
        if self._services.pop(service, service) is None:
            self.service_index.remove(service)
            self._timers.set(service, None)
            for register in (self._touched, self._blocked, self._failed):
                register.pop(service, None)

    def touch(self, service: Service) -> None:
        """Mark a service whose methods were called: its messages, events and timer are processed next."""
        if service in self._services:
            self._touched[service] = None

    # Bytes and messages

    def receive(self, channel: ChannelState, data: bytes, now: float) -> list[Packet]:
        """Handle bytes of a channel; return the packets without duplicates."""
        return self.handle(channel, channel.receive(data, now), now)

    def handle(self, channel: ChannelState, packets: list[Packet], now: float) -> list[Packet]:
        """Handle packets that were received on a channel; return them without duplicates."""
        return [packet for packet in packets if self._handle(packet, channel, now)]

    def send(
        self, message: Message, now: float, target: Address | None = None, *, source: Address | None = None
    ) -> None:
        """Send a message of the program to a target, or to the address in its target fields."""
        self._to_send += self.encode(message, now, target, source=source)

    def encode(
        self, message: Message, now: float, target: Address | None = None, *, source: Address | None = None
    ) -> list[tuple[ChannelState, bytes]]:
        """Return the data of a message of the program, which the caller writes to each channel."""
        target, source = target or target_of(message), source or self.local
        if error := self.senders.refusal(message, target):
            raise error
        if carries_key(message) and (reason := self.key_channels.refusal(target)):
            raise SigningError(f"sending a signing key to {target} failed: {reason}")
        channels = self.key_channels.leading_to(target)
        return [(channel, channel.encode(message, source, now, Priority.CONTROL)) for channel in channels]

    def forward(self, packet: Packet, now: float, target: Address | None = None) -> None:
        """Send a packet of another component unchanged, over all channels that heard its target, or `target`.

        SETUP_SIGNING, which carries a key, is never forwarded, nor RADIO_STATUS, which is about one link.
        """
        if carries_signing_key(packet) or packet.message_id == _RADIO_STATUS:
            return
        for channel in self.routes.all_channels_to(target or target_of(packet.message), self.channels):
            channel.pacer.sent(len(packet.raw), now, Priority.STREAM)
            self._to_send.append((channel, packet.raw))

    def data_to_send(self, now: float) -> list[tuple[ChannelState, bytes]]:
        """Return the data to write to each channel."""
        self._process_touched(now)
        data, self._to_send = self._to_send, []
        return data

    def events(self) -> list[tuple[Service, Event]]:
        """Return the events of services since the last call."""
        events, self._events = self._events, []
        return events

    # Time

    def next_timeout(self) -> float | None:
        """Return when to call `handle_timeout`; None: nothing is due."""
        first = self._timers.next_timeout()
        return earliest(first, *self._blocked.values()) if self._blocked else first

    @property
    def idle(self) -> bool:
        """True if there is nothing to send and no event until bytes are received or a timer is due."""
        return not (self._touched or self._to_send or self._events)

    def handle_timeout(self, now: float) -> None:
        """Process the services whose timers are due or whose channels have room for bulk again."""
        for service in self._timers.pop_due(now):
            self._touched[service] = None
            try:
                service.handle_timeout(now)
            except Exception as error:  # noqa: BLE001 (the other services continue)
                self._fail(service, error)
        self._touched.update((service, None) for service, due in self._blocked.items() if due <= now)

    # Processing

    def _handle(self, packet: Packet, channel: ChannelState, now: float) -> bool:
        message_id, system = packet.message_id, packet.system
        source = system, packet.component
        if channel.verifies:
            verified = packet.signed
            if not verified:
                return self._handle_unsigned(packet, channel, now)
        else:
            verified = packet.signed and self.adopt_key(channel, packet, now)
            if not verified and (channel.verifies or self.routes.is_verified(source)):
                channel.unverified += 1
                return False
        if self.senders.is_limited and self.senders.excludes(system, channel):
            return self._handle_excluded(packet, channel, now)
        redundant = self.routes.learn(source, channel, now, verified=verified)
        if redundant and self.duplicates.is_copy(packet, channel, now):
            return False
        if message_id == _RADIO_STATUS and packet.message is not None and is_radio(packet.component):
            channel.pacer.radio_status(packet.message.txbuf, now)
        services = self.service_index.find(message_id, system)
        if services and packet.message is not None:
            self.arrived_on = channel
            self._deliver(packet, services, now)
            self.arrived_on = None
        return True

    def _handle_excluded(self, packet: Packet, channel: ChannelState, now: float) -> bool:
        """Handle a packet of a sender that was not chosen: it shows only that the sender is there."""
        if packet.message is not None:
            self.arrived_on = channel
            services = self.service_index.find(packet.message_id, packet.system)
            self._deliver(packet, [each for each in services if each.observes_all_senders], now)
            self.arrived_on = None
        return False

    def _handle_unsigned(self, packet: Packet, channel: ChannelState, now: float) -> bool:
        """Handle a packet accepted unsigned: the report of a radio is shown, and changes nothing."""
        if packet.message_id != _RADIO_STATUS:
            return False
        return is_radio(packet.component) and not self.routes.knows_system(packet.system)

    def _deliver(self, packet: Packet, services: Iterable[Service], now: float) -> None:
        """Deliver a packet to those services that it is addressed to."""
        target = target_of(packet.message)
        source = packet.system, packet.component
        for service in services:
            if target.covers(service.local) and (source != service.local or service.accepts_own_packets):
                try:
                    if service.receive(packet, now) is not False:
                        self._touched[service] = None
                except Exception as error:  # noqa: BLE001 (as above)
                    self._touched[service] = None
                    self.on_failure(service, error)

    def _fail(self, service: Service, error: Exception) -> None:
        self._failed[service] = None
        self.on_failure(service, error)

    def _process_touched(self, now: float) -> None:
        """Drain the touched services, in order, until none is left."""
        while self._touched:
            service = next(iter(self._touched))
            del self._touched[service]
            self._collect_events(service)  # apply a change of keys before the messages after it are sent
            try:
                self._drain(service, now)
            except Exception as error:  # noqa: BLE001 (as above)
                self._fail(service, error)
            self._collect_events(service)
            self.service_index.update(service)
            self._set_timer(service, now)

    def _collect_events(self, service: Service) -> None:
        for event in service.events():
            if isinstance(event, KeyEvent):
                self._apply_key_event(event)
            self._events.append((service, event))

    def _apply_key_event(self, event: KeyEvent) -> None:
        channels = self.routes.heard_on(event.peer)
        apply_key_event(event, channels, self.signing_states)
        for channel in channels:
            if not channel.verifies:
                self.routes.unverify(channel)
        if isinstance(event, KeySettled):
            self.key_channels.release(event.peer)

    def _drain(self, service: Service, now: float) -> None:
        self._blocked.pop(service, None)

        def has_room(target: Address, priority: Priority = Priority.BULK, channel: str = "") -> bool:
            return self._has_room(service, self.key_channels.leading_to(target, channel), priority, now)

        for outgoing in service.messages_to_send(now, has_room):
            if error := self.senders.refusal(outgoing.message, outgoing.target):
                service.handle_refusal(error, now)
            else:
                self._dispatch(outgoing, service.local, now)

    def _has_room(
        self, service: Service, channels: Sequence[ChannelState], priority: Priority, now: float
    ) -> bool:
        for channel in channels:
            pacer = channel.pacer
            if pacer.bandwidth is not None or (priority is Priority.BULK and pacer.bulk_rate is not None):
                break
        else:
            return bool(channels)
        full = [channel for channel in channels if not channel.pacer.has_room(priority, now)]
        if priority is Priority.STREAM and len(full) < len(channels):
            return True  # a slow link drops stream messages, which the other links transmit
        if full:
            again = max(channel.pacer.room_at(now) for channel in full)
            known = self._blocked.get(service, again)
            self._blocked[service] = max(min(again, known), now + 0.001)
        return bool(channels) and not full

    def _dispatch(self, outgoing: Outgoing, source: Address, now: float) -> None:
        message, target, priority, name = outgoing
        if carries_key(message) and self.key_channels.refusal(target):
            return
        for channel in self.key_channels.leading_to(target, name):
            if priority is Priority.STREAM and not channel.pacer.has_room(Priority.STREAM, now):
                channel.thinned += 1
                continue
            try:
                data = channel.encode(message, source, now, priority)
            except EncodeError:
                channel.unsendable += 1
            else:
                self._to_send.append((channel, data))
                if source == self.local and isinstance(message, common.Heartbeat):
                    self._heartbeats.record(data, now)

    def _set_timer(self, service: Service, now: float) -> None:
        due = service.next_timeout()
        failed = self._failed.pop(service, service) is None
        if failed and due is not None:
            due = max(due, now + FAILURE_INTERVAL)
        self._timers.set(service, due)


def _raise(service: Service, error: Exception) -> None:
    raise error
