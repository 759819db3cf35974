"""The native input of a node: packets that are not wanted cost Python nothing.

A thread of the core (`mavstack._core.Intake`) reads the sockets of UDP links, parses and counts the packets,
and keeps the latest one of each message and source. Every packet comes to the engine until the node knows
that it need not:

- A channel is attached if its packets need nothing but a parser: without signing, MAVLink version to follow,
  and half-duplex air time (`ChannelState.is_plain`).
- A source is granted on a channel if it is heard there alone, is not verified elsewhere, and no channel was
  chosen or set as the only one. As soon as one of these changes, all its packets come to the engine again.
- Of a granted source the packets of a message are left out if no service, listener or subscription takes it.
  Of messages with a boot time the discovery of components needs only those that it does not expect.

Signed packets always come. The times of packets that were left out are added to the routes and to the
discovery of components before these depend on them.
"""

from __future__ import annotations

import asyncio
import os
from dataclasses import dataclass
from enum import IntEnum
from functools import partial
from itertools import count
from time import monotonic, time
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.links.udp_channel import UdpChannel
from mavstack.node.dispatch import ANY
from mavstack.node.message_fields import BOOT_FIELDS
from mavstack.services import message_ids

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links import Channel, Link
    from mavstack.links.native_reading import NativeReading
    from mavstack.node.channel_state import ChannelState
    from mavstack.node.host import NodeHost
    from mavstack.wire import Packet

#: Seconds for which the thread reads without rests after the program sent something that is answered.
HURRY_TIME: Final = 0.1

_RADIO_STATUS: Final = message_ids(common.RadioStatus)
#: Messages that come regularly or unasked: they come together with others.
_UNHURRIED: Final = message_ids(common.Heartbeat, common.GlobalPositionInt, common.Statustext)


class Level(IntEnum):
    """The interest of the node in a message of a source, as the core numbers it."""

    NOTHING = 1
    NEW_BOOT = 2
    SOON = 3
    NOW = 4


@dataclass(frozen=True, slots=True)
class Attached:
    """A channel whose packets the thread parses."""

    channel: UdpChannel
    state: ChannelState


class NativeInput:
    """The part of a driver that works with the thread; exists while its node is open.

    Args:
        host: The host of the node.
        deliver: Called with packets of a channel, and whether they were kept as latest packets already.
        step: Called after packets were delivered.
        now: Returns the time of the driver.
    """

    def __init__(
        self,
        host: NodeHost,
        deliver: Callable[[Attached, list[Packet], bool], None],
        step: Callable[[], None],
        now: Callable[[], float],
    ) -> None:
        self._host = host
        self._intake = host.intake
        self._deliver = deliver
        self._step = step
        self._now = now
        self._numbers = count()
        self._readings: dict[int, NativeReading] = {}
        self._by_link: dict[Link, NativeReading] = {}
        self._waiting: dict[UdpChannel, tuple[ChannelState, NativeReading]] = {}
        self._attached: dict[int, Attached] = {}
        self._number_of: dict[str, int] = {}
        self._loop = asyncio.get_running_loop()
        self._descriptor: int | None = None

    # Links and channels

    def add(self, link: Link) -> None:
        """Let the thread read an open link, if it can."""
        if self._descriptor is None:
            self._start()
        number = next(self._numbers)
        reading = link.read_natively(self._intake, number)
        if reading is not None:
            self._readings[number] = self._by_link[link] = reading

    def _start(self) -> None:
        self._descriptor = self._intake.start(self._now())
        self._loop.add_reader(self._descriptor, self._on_readable)
        self._follow_changes()

    def channel_opened(self, channel: Channel, state: ChannelState, link: Link) -> None:
        """Attach a new channel as soon as possible."""
        reading = self._by_link.get(link)
        if reading is not None and isinstance(channel, UdpChannel):
            self._waiting[channel] = state, reading

    def channel_closed(self, channel: Channel) -> None:
        """Forget a channel that was closed."""
        if isinstance(channel, UdpChannel):
            self._waiting.pop(channel, None)

    def settle(self) -> None:
        """Attach the channels that can be attached now: of which nothing waits any more."""
        for channel, (state, reading) in tuple(self._waiting.items()):
            number = next(self._numbers)
            if state.is_plain and not channel.closed and reading.attach(number, channel, state.parser):
                del self._waiting[channel]
                self._attached[number] = Attached(channel, state)
                self._number_of[state.name] = number
                channel.refresh = partial(self._refresh, channel, number)
                channel.on_removed = partial(self._detach, number)
                state.on_parser_changed = partial(self._detach, number, reading)

    def _detach(self, number: int, reading: NativeReading | None = None) -> None:
        """Let the datagrams of a channel come to the link again; with a reading, until it can be attached."""
        attached = self._attached.pop(number)
        channel, state = attached.channel, attached.state
        self._sync_heard()
        self._add_received(channel, *self._intake.detach(number))
        del self._number_of[state.name]
        channel.refresh = channel.on_removed = state.on_parser_changed = lambda: None
        if reading is not None:
            self._waiting[channel] = state, reading

    def _refresh(self, channel: UdpChannel, number: int) -> None:
        self._add_received(channel, *self._intake.activity(number))

    def _add_received(
        self, channel: UdpChannel, size: int, chunks: int, received_at: float, valid_at: float
    ) -> None:
        if chunks:
            ahead = time() - self._now()  # the clock of links is that of the system
            channel.note_received(size, chunks, received_at + ahead, valid_at + ahead if valid_at else 0.0)

    def hurry(self) -> None:
        """Let packets come without delay for a moment, because an answer is awaited."""
        self._intake.hurry(HURRY_TIME)

    def stop(self) -> None:
        """Stop the thread; the links read no more."""
        for number in tuple(self._attached):
            self._detach(number)
        self._waiting.clear()
        if self._descriptor is not None:
            self._loop.remove_reader(self._descriptor)
            self._descriptor = None
            self._intake.stop()
            self._unfollow_changes()

    # Packets

    def _on_readable(self) -> None:
        runs, datagrams, undecided, overloaded = self._intake.take()
        for number, packets, is_kept in runs:
            attached = self._attached.get(number)
            if attached is not None:
                self._deliver(attached, packets, is_kept)
                if not is_kept:
                    self._grant(number, attached.state, packets)
        for source, message_id in undecided:
            self._intake.decide(source, message_id, self._level(source, message_id))
        for socket, address, data, chunks in datagrams:
            self._readings[socket].receive(data, address, chunks)
        for socket in overloaded:
            self._readings[socket].take_over()
        self.settle()
        self._step()

    def _grant(self, number: int, state: ChannelState, packets: list[Packet]) -> None:
        for source in {(packet.system, packet.component) for packet in packets if not packet.signed}:
            if self._may_grant(state, source):
                self._intake.grant(number, source)

    def _may_grant(self, state: ChannelState, source: tuple[int, int]) -> bool:
        engine = self._host.engine
        return (
            source != engine.local
            and not engine.senders.is_limited
            and not engine.routes.is_verified(source)
            and engine.routes.is_heard_only_on(source, state)
        )

    def _level(self, source: tuple[int, int], message_id: int) -> Level:
        """Return who takes a message of a source."""
        if message_id in _RADIO_STATUS or self._host.packet_dispatch.has_listeners(message_id, source):
            found = Level.SOON
        else:
            found = Level.NOTHING
        discovery = self._host.discovery
        services = self._host.engine.service_index.find(message_id, source[0])
        others = [service for service in services if service is not discovery]
        if others:
            return Level.SOON if message_id in _UNHURRIED else Level.NOW
        if services and found is Level.NOTHING:
            return Level.NEW_BOOT if message_id in BOOT_FIELDS else Level.SOON
        return found

    # Changes elsewhere

    def _follow_changes(self) -> None:
        host, engine = self._host, self._host.engine
        engine.routes.before_change = self._revoke
        engine.routes.before_removal = self._sync_heard
        engine.senders.before_change = self._revoke_all
        engine.service_index.on_change = self._services_changed
        host.packet_dispatch.on_change = self._listeners_changed
        host.discovery.filters.on_change = self._boot_changed
        host.discovery.filters.before_reading = self._sync_heard

    def _unfollow_changes(self) -> None:
        host, engine = self._host, self._host.engine
        engine.routes.before_change = lambda address: None
        engine.routes.before_removal = engine.senders.before_change = lambda: None
        host.discovery.filters.before_reading = lambda: None
        engine.service_index.on_change = lambda ids, system: None
        host.packet_dispatch.on_change = lambda ids, system: None
        host.discovery.filters.on_change = lambda key, boot: None
        self._intake.forget_decisions(None, 0)

    def _revoke(self, source: tuple[int, int]) -> None:
        for number, heard_at in self._intake.revoke(source):
            if (attached := self._attached.get(number)) is not None:
                self._host.engine.routes.note_heard(source, attached.state, heard_at)

    def _revoke_all(self) -> None:
        self._sync_heard()
        self._intake.revoke_all()

    def _services_changed(self, ids: frozenset[int], system: int) -> None:
        for message_id in ids:
            self._intake.forget_decisions(message_id, system)

    def _listeners_changed(self, ids: tuple[int, ...], system: int) -> None:
        for message_id in ids:
            self._intake.forget_decisions(None if message_id == ANY else message_id, system)

    def _boot_changed(self, key: tuple[int, int, str], boot: tuple[int, float] | None) -> None:
        system, component, channel = key
        if (number := self._number_of.get(channel)) is not None:
            self._intake.expect_boot(number, (system, component), boot)

    def _sync_heard(self) -> None:
        """Add the times of packets that were left out to the routes and to the discovery."""
        routes, filters = self._host.engine.routes, self._host.discovery.filters
        for number, source, heard_at, seen_at in self._intake.sources():
            if (attached := self._attached.get(number)) is not None:
                routes.note_heard(source, attached.state, heard_at)
                filters.note_seen((*source, attached.state.name), seen_at)


def is_possible(loop: asyncio.AbstractEventLoop) -> bool:
    """Return whether an event loop can wait for the thread: it watches descriptors, in real time."""
    is_chosen = os.environ.get("MAVSTACK_INPUT", "native") != "asyncio"
    return is_chosen and isinstance(loop, asyncio.SelectorEventLoop) and abs(loop.time() - monotonic()) < 1.0
