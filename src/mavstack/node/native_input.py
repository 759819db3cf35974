"""The native input of a node: packets that are not wanted cost Python nothing.

The core (`mavstack._core.Intake`) reads UDP sockets, TCP connections, Unix sockets and serial ports, parses
and counts the packets, and keeps the latest one of each message and source. A thread of the core waits for
them; if the program handles most packets, or waits for an answer, the event loop does, which saves one
wake-up. The bytes that the event loop reads from other links are fed to the core. Every packet comes to the
engine until the node knows that it need not:

- A channel is attached if its packets need nothing but a parser: without signing, MAVLink version to follow,
  and half-duplex air time (`ChannelState.is_plain`).
- A source is granted on a channel if it is heard there alone, is not verified elsewhere, and no channel was
  chosen or set as the only one. As soon as one of these changes, all its packets come to the engine again.
- Of a granted source the packets of a message are left out if no service, listener or subscription takes it.
  Those that only listeners take need no check of the engine, and the core calls the listeners. Of messages
  with a boot time the discovery of components needs only those that it does not expect.

Packets that wait in the core when a channel is attached or a source granted are treated like later ones.
Those that wait when a channel closes or gets a key are handled before its end, or parsed again with the key;
when the node closes they are dropped. Signed packets always come. The arrival and the boot times of packets
that were left out are added to the routes and to the discovery of components before these depend on them.
"""

from __future__ import annotations

import asyncio
import os
from dataclasses import replace
from functools import partial
from itertools import count
from time import monotonic, time
from typing import TYPE_CHECKING, Final

from mavstack.links.native_stream import StreamReading, end_reading
from mavstack.links.stream import StreamChannel
from mavstack.links.udp_channel import UdpChannel
from mavstack.node.dispatch import ANY
from mavstack.node.input_interval import InputInterval
from mavstack.node.native_interest import interest_of_services
from mavstack.node.native_runs import Attached, Run, Taken

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links import Channel, Link
    from mavstack.links.native_reading import NativeReading
    from mavstack.node.channel_state import ChannelState
    from mavstack.node.host import NodeHost
    from mavstack.wire import Packet

#: Seconds for which the thread reads without pauses after the node has sent a request.
HURRY_TIME: Final = 0.1
#: Maximum number of reads in a row before other tasks of the event loop run.
MAX_ROUNDS: Final = 4
#: Maximum seconds since the last read for which the event loop reads several times in a row.
ROUND_TIME: Final = 0.0002
#: Maximum number of takes after which nothing is left of what waited in the core.
MAX_TAKES: Final = 32
#: Minimum length of the packets that the core returns at once.
MIN_TAKEN_BYTES: Final = 4096
#: Reads that may return packets from before a grant was revoked: the current one and the next one.
STALE_TAKES: Final = 2


class NativeInput:
    """The part of a driver that works with the thread; exists while its node is open.

    Args:
        host: The host of the node.
        deliver: Called with packets of a channel.
        step: Called after packets were delivered.
        now: Returns the time of the driver.
    """

    def __init__(
        self,
        host: NodeHost,
        deliver: Callable[[Run], None],
        step: Callable[[], None],
        now: Callable[[], float],
    ) -> None:
        self._host = host
        self._intake = host.intake
        self._deliver = deliver
        self._step = step
        self._now = now
        self._numbers = count()
        self._readings: dict[int, NativeReading | StreamReading] = {}
        self._by_socket: dict[int, NativeReading] = {}
        self._by_link: dict[Link, NativeReading] = {}
        self._waiting: dict[Channel, Attached] = {}
        self._attached: dict[int, Attached] = {}
        self._number_by_channel: dict[Channel, int] = {}
        self._number_of: dict[str, int] = {}
        self._loop = asyncio.get_running_loop()
        self._descriptor: int | None = None
        self._is_direct = False
        self._stale_takes = 0
        self._taken = Taken()
        #: The interval of reads while the event loop reads the sockets.
        self.interval = InputInterval(host.input_interval, self._look, self._watch)
        self._looked_at = 0.0

    # Links and channels

    def add(self, link: Link) -> None:
        """Let the thread read an open link, if it can."""
        if self._descriptor is None:
            self._start()
        number = next(self._numbers)
        reading = link.read_natively(self._intake, number)
        if reading is not None:
            self._readings[number] = self._by_socket[number] = self._by_link[link] = reading
            if self._is_direct:
                reading.watch(self._on_readable)

    def _start(self) -> None:
        self._descriptor = self._intake.start(self._now())
        self._loop.add_reader(self._descriptor, self._on_readable)
        self._follow_changes()

    def channel_opened(self, channel: Channel, state: ChannelState, link: Link) -> None:
        """Attach a new channel as soon as possible."""
        self._waiting[channel] = Attached(channel, state, self._by_link.get(link), state.parser)

    def channel_closed(self, channel: Channel) -> None:
        """Forget a channel that was closed, after its packets were handled; it is open in the engine."""
        self._waiting.pop(channel, None)
        if (number := self._number_by_channel.get(channel)) is not None:
            self._detach(number)
        self._taken.handle()

    def settle(self) -> None:
        """Attach the channels that can be attached now: everything that was taken of them was handled."""
        if not self._taken.is_handled:
            return
        for channel, attached in tuple(self._waiting.items()):
            number, state = next(self._numbers), attached.state
            if not state.is_plain or channel.closed:
                end_reading(channel)
            elif self._attach(number, attached):
                del self._waiting[channel]
                self._attached[number] = replace(attached, parser=state.parser)
                self._number_by_channel[channel] = number
                self._number_of[state.name] = number
                state.on_parser_changed = partial(self._detach, number, waits=True)

    def _attach(self, number: int, attached: Attached) -> bool:
        channel, parser = attached.channel, attached.state.parser
        if isinstance(channel, StreamChannel) and channel.may_be_read_natively():
            stream = StreamReading.attach(channel, self._intake, number, parser)
            if stream is None:
                return False
            self._readings[number] = stream
            if self._is_direct:
                stream.watch(self._on_readable)
        elif attached.reading is None:
            self._intake.attach_fed(number, parser)
            return True
        elif not isinstance(channel, UdpChannel) or not attached.reading.attach(number, channel, parser):
            return False
        channel.refresh = partial(self._refresh, channel, number)
        channel.on_closing = partial(self._detach, number)
        return True

    def _detach(self, number: int, *, waits: bool = False) -> None:
        """Let the bytes of a channel come to the engine again; if it waits, until it can be attached."""
        self._sync_heard()
        if stream := self._readings.pop(number, None):
            stream.stop()
        received = self._intake.detach(number)
        self._collect_all()
        attached = self._attached.pop(number)
        channel, state = attached.channel, attached.state
        del self._number_by_channel[channel]
        self._add_received(channel, *received)
        channel.refresh = channel.on_closing = lambda: None
        del self._number_of[state.name]
        state.on_parser_changed = lambda: None
        if waits:
            self._waiting[channel] = attached
        if not self._taken.is_handled:
            self._loop.call_soon(self._finish_look)

    def _refresh(self, channel: Channel, number: int) -> None:
        self._add_received(channel, *self._intake.activity(number))

    def _add_received(
        self, channel: Channel, size: int, chunks: int, received_at: float, valid_at: float
    ) -> None:
        if chunks:
            ahead = time() - self._now()  # links use the system clock
            channel.note_received(size, chunks, received_at + ahead, valid_at + ahead if valid_at else 0.0)

    def hurry(self) -> None:
        """Let packets come without delay for a moment, because an answer is awaited."""
        self.interval.hurry(HURRY_TIME)
        self._read_directly(self._intake.hurry(HURRY_TIME))

    def _read_directly(self, is_direct: bool) -> None:
        """Wait for the sockets by the event loop, or let the thread do so."""
        if is_direct is not self._is_direct:
            self._is_direct = is_direct
            self.interval.end()
            self._watch(is_direct)

    def _watch(self, is_watching: bool) -> None:
        for reading in self._readings.values():
            reading.watch(self._on_readable if is_watching else None)

    def stop(self) -> None:
        """Stop the thread; the links read no more."""
        for number in tuple(self._attached):
            self._detach(number)
        for channel in self._waiting:
            end_reading(channel)
        self._waiting.clear()
        self._taken.clear()
        self._read_directly(False)
        if self._descriptor is not None:
            self._loop.remove_reader(self._descriptor)
            self._descriptor = None
            self._intake.stop()
            self._unfollow_changes()

    # Packets

    def _on_readable(self) -> None:
        """Handle packets; look again at once if that lately was worth it, or should have been done."""
        is_worth = monotonic() < self._looked_at + ROUND_TIME
        rounds = 1
        while self._take() and is_worth and rounds < MAX_ROUNDS:
            rounds += 1
        self._looked_at = monotonic()
        self._finish_look()
        if self._is_direct:
            self.interval.begin()

    def _look(self) -> bool:
        """Handle what waits; return whether there was anything and the event loop is to read on."""
        is_found = self._take()
        self._finish_look()
        return is_found

    def _finish_look(self) -> None:
        self._taken.handle()
        if self._waiting:
            self.settle()
        self._step()

    def feed(self, channel: Channel, data: bytes) -> bool | None:
        """Receive bytes that the event loop read; return whether a packet is valid; None: not fed."""
        number = self._number_by_channel.get(channel)
        if number is None:
            self._taken.handle()  # what was received before these bytes
            return None
        is_valid = self._intake.feed(number, data, self._now())
        takes = 1 + len(data) // MIN_TAKEN_BYTES
        while self._take_once() and takes > 1:
            takes -= 1
        return is_valid

    def call_listeners(self, packets: list[Packet], fail: Callable[[Exception], None]) -> None:
        """Call the listeners of packets, in order, and a function with each exception of theirs."""
        self._intake.deliver(packets, self._host.packet_dispatch.functions_for, fail)

    def _take(self) -> bool:
        """Handle what waits in the core; return whether more may come without a wait."""
        return self._take_once() and self._is_direct

    def _take_once(self) -> bool:
        """Handle a part of what waits in the core; return whether there were packets."""
        is_found = self._collect()
        self._taken.handle()
        if self._stale_takes:
            self._stale_takes -= 1
        return is_found

    def _collect(self) -> bool:
        """Take a part of what waits in the core, to be handled; return whether there were packets."""
        runs, datagrams, undecided, overloaded, is_direct = self._intake.take()
        self._read_directly(is_direct)
        for number, packets, listened, is_kept in runs:
            if (attached := self._attached.get(number)) is not None:
                run = Run(attached, packets, listened, is_kept, is_checked=True)
                self._taken.calls.append(partial(self._handle_run, run))
                # The core keeps the packets that follow: they have to be newer than all that were taken.
                if not is_kept:
                    self._taken.afterwards.append(partial(self._grant, number, packets))
        for socket, address, data, chunks in datagrams:
            self._taken.calls.append(partial(self._by_socket[socket].receive, data, address, chunks))
        self._taken.afterwards += [partial(self._decide, *each) for each in undecided]
        self._taken.afterwards += [partial(self._take_over, *each) for each in overloaded]
        return bool(runs)

    def _collect_all(self) -> None:
        """Take what waits in the core, of a channel that it parses no more."""
        takes = 1
        while self._collect() and takes < MAX_TAKES:
            takes += 1

    def _handle_run(self, run: Run) -> None:
        self._deliver(run._replace(is_checked=False) if self._stale_takes else run)

    def _take_over(self, socket: int, error: int) -> None:
        if (reading := self._readings.get(socket)) is not None:
            reading.take_over(error)

    def _grant(self, number: int, packets: list[Packet]) -> None:
        if (attached := self._attached.get(number)) is None:
            return
        for source in {(packet.system, packet.component) for packet in packets if not packet.signed}:
            if self._may_grant(attached.state, source):
                self._intake.grant(number, source)

    def _may_grant(self, state: ChannelState, source: tuple[int, int]) -> bool:
        engine = self._host.engine
        return (
            source != engine.local
            and not engine.senders.is_limited
            and not engine.routes.is_verified(source)
            and engine.routes.is_heard_only_on(source, state)
        )

    def _decide(self, source: tuple[int, int], message_id: int) -> None:
        listeners = self._host.packet_dispatch.functions(message_id, source)
        level = interest_of_services(self._host, source, message_id)
        self._intake.decide(source, message_id, level, listeners)

    # Changes of routes, services and listeners

    def _follow_changes(self) -> None:
        host, engine = self._host, self._host.engine
        engine.routes.before_change = self._revoke
        engine.routes.before_removal = self._sync_heard
        engine.senders.before_change = self._revoke_all
        engine.service_index.on_change = self._services_changed
        host.packet_dispatch.on_change = self._listeners_changed
        host.discovery.filters.on_change = self._boot_changed
        host.discovery.filters.before_reading = self._sync_heard
        host.discovery.filters.last_boot = self._last_boot

    def _unfollow_changes(self) -> None:
        host, engine = self._host, self._host.engine
        engine.routes.before_change = lambda address: None
        engine.routes.before_removal = engine.senders.before_change = lambda: None
        host.discovery.filters.before_reading = lambda: None
        engine.service_index.on_change = lambda ids, system: None
        host.packet_dispatch.on_change = lambda ids, system: None
        host.discovery.filters.on_change = lambda key, boot: None
        host.discovery.filters.last_boot = lambda key: None
        self._intake.forget_decisions(None, 0)

    def _revoke(self, source: tuple[int, int]) -> None:
        self._stale_takes = STALE_TAKES
        for number, heard_at, boot in self._intake.revoke(source):
            self._note(number, source, heard_at, boot)

    def _revoke_all(self) -> None:
        self._stale_takes = STALE_TAKES
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
        for number, source, heard_at, boot in self._intake.sources():
            self._note(number, source, heard_at, boot)

    def _note(self, number: int, source: tuple[int, int], at: float, boot: tuple[int, float] | None) -> None:
        """Add the time of the last packet of a source, and its last expected boot time."""
        if (attached := self._attached.get(number)) is None:
            return
        self._host.engine.routes.note_heard(source, attached.state, at)
        if boot is not None:
            self._host.discovery.note_boot((*source, attached.state.name), *boot)

    def _last_boot(self, key: tuple[int, int, str]) -> tuple[int, float] | None:
        system, component, channel = key
        number = self._number_of.get(channel)
        return None if number is None else self._intake.boot(number, (system, component))


def is_possible(loop: asyncio.AbstractEventLoop) -> bool:
    """Return whether an event loop can wait for the thread: it watches descriptors, in real time."""
    is_chosen = os.environ.get("MAVSTACK_INPUT", "native") != "asyncio"
    return is_chosen and isinstance(loop, asyncio.SelectorEventLoop) and abs(loop.time() - monotonic()) < 1.0
