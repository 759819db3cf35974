"""Endpoints whose bytes Python carries: WebSockets, TLS, sealed links, replayed files, and others.

Each channel of the link is a queue of the engine. A channel that is slower than its packets first fills the
send queue of the link; then its packets wait in the engine, where each endpoint has its share of the room;
then it loses its own packets, which are counted, and delays no other.
"""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from time import monotonic, time
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError, LinkClosedError
from mavstack.links.events import BytesReceived, ChannelClosed, ChannelOpened
from mavstack.links.scheme_table import find_scheme
from mavstack.router.endpoints.base import DOWN, ENDED, LISTENING, OPEN, Endpoint
from mavstack.router.endpoints.client_proofs import ClientProofs
from mavstack.router.high_latency import HighLatency
from mavstack.router.peer import Peer
from mavstack.security.admission import Proof

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from mavstack.links.base import Link
    from mavstack.links.channel import Channel
    from mavstack.links.events import LinkEvent
    from mavstack.router.attachments import Attachments
    from mavstack.router.config import EndpointConfig

_log = logging.getLogger("mavstack.router")
#: Maximum size in bytes of a chunk of several packets, such as one message of a WebSocket.
MAX_CHUNK: Final = 4096
#: Seconds for which the engine keeps a closed channel, since the firewall may still inspect its last packets.
LINGER_TIME: Final = 0.1
#: Seconds until the packets of a replayed recording are given again to an engine whose queue was full.
RETRY_INTERVAL: Final = 0.01


class CarriedEndpoint(Endpoint):
    """A link of `mavstack.links`, with a queue of the engine for each channel."""

    def __init__(self, config: EndpointConfig, attachments: Attachments, link: Link) -> None:
        super().__init__(config, attachments)
        self._link = link
        self._channels: dict[int, Channel] = {}
        self._by_channel: dict[Channel, int] = {}
        self._dropped: dict[int, int] = {}
        self._profiles: dict[int, HighLatency] = {}
        self._sent: dict[int, tuple[int, int]] = {}
        self._slow: set[int] = set()  # channels that have no room for further packets now
        self._proofs = ClientProofs(attachments.engine)
        link.before_choice = self._update_proofs
        scheme = find_scheme(link.url.scheme)
        #: True if several packets may share one chunk (a stream); False if each chunk is a datagram.
        self._joins = scheme is not None and scheme.is_stream

    @property
    def address(self) -> tuple[str, int] | None:
        """Host and port on which the link listens, or None."""
        return self._link.address

    @property
    def dropped(self) -> Mapping[int, int]:
        """Packets lost by slow clients, and chunks that came faster than they were routed, by number."""
        return self._dropped

    @property
    def sent(self) -> Mapping[int, tuple[int, int]]:
        """Packets and bytes sent on links with the profile of satellite links, by the engine's number."""
        return self._sent

    async def open(self) -> None:
        """Open the link."""
        await self._link.open()
        self.state = LISTENING
        self._spawn(self._read())
        if self.config.high_latency is not None:
            self._spawn(self._send_summaries(self.config.high_latency))
        await asyncio.sleep(0)  # let the reader handle the channels that are open already

    async def close(self) -> None:
        """Close the link; queued bytes are sent first."""
        await super().close()
        await self._link.close()

    def readable(self, number: int) -> None:
        """Send the packets that wait for a channel, unless it has no room yet."""
        channel = self._channels.get(number)
        if channel is None or number in self._slow:
            return
        packets = self._attachments.engine.pull(number)
        profile = self._profiles.get(number)
        if profile is not None:
            now = monotonic()
            packets = [kept for packet in packets for kept in profile.receive(packet, now)]
        if rest := self._write(number, channel, packets):
            self._slow.add(number)
            self._spawn(self._send_later(number, channel, rest))

    async def _send_later(self, number: int, channel: Channel, rest: Sequence[bytes]) -> None:
        """Send packets when their channel has room; further ones wait in the engine."""
        with suppress(LinkClosedError):
            while rest and not channel.closed:
                await channel.drain()
                before, rest = rest, self._write(number, channel, rest)
                if len(rest) == len(before):
                    # the channel took nothing, and has no queue whose end could be awaited
                    break
        self._count_dropped(number, len(rest))
        self._slow.discard(number)
        self.readable(number)

    async def _read(self) -> None:
        if self._link.url.scheme == "file":
            await self._replay()
        else:
            await self._link.read(self._receive)
        self.state, self.reason = ENDED, self.reason or "the link ended"

    async def _replay(self) -> None:
        """Route a recording, which waits while the engine has no room."""
        async for event in self._link:
            if not isinstance(event, BytesReceived):
                self._receive((event,))
                continue
            while not self._push(event.channel, event.data):  # noqa: ASYNC110 (the engine tells no event)
                await asyncio.sleep(RETRY_INTERVAL)

    def _receive(self, events: Sequence[LinkEvent]) -> None:
        for event in events:
            match event:
                case BytesReceived(channel, data, _):
                    if not self._push(channel, data):
                        self._count_dropped(self._by_channel[channel], 1)
                case ChannelOpened(channel):
                    self._open_channel(channel)
                case ChannelClosed(channel, reason):
                    self._close_channel(channel, reason)
                case _:
                    self.state, self.reason = DOWN, event.reason

    def _push(self, channel: Channel, data: bytes) -> bool:
        """Route bytes of a channel; return False if the engine has no room for them yet."""
        number = self._by_channel.get(channel)
        if number is None:
            return True
        if number in self._profiles:
            self._profiles[number].receive_request(data, monotonic())
        try:
            return self._attachments.engine.push(number, data)
        except InvalidArgumentError:  # the engine has closed the endpoint
            self._close_channel(channel, "closed by the router")
            return True

    def _open_channel(self, channel: Channel) -> None:
        name = self.config.name if channel.name.endswith(self._link.url.path or "?") else ""
        name = name or f"{self.config.name} {channel.peer}"
        number = self._attachments.engine.add_queue(name=name, start=False)
        if self.config.high_latency is not None:
            self._profiles[number] = HighLatency(self._attachments.dialect, self.config.high_latency)
        self._channels[number], self._by_channel[channel] = channel, number
        self._dropped[number] = 0
        self._proofs.add(number, channel.host, monotonic())
        self._attach(number, name, peer=_peer_of(channel.peer), credential=channel.identity)
        _log.info("%s connected", name)

    def _close_channel(self, channel: Channel, reason: str) -> None:
        number = self._by_channel.pop(channel, None)
        if number is None:
            return
        _log.info("%s left: %s", self._numbers.get(number, self.config.name), reason)
        del self._channels[number]
        self._proofs.remove(number)
        self._spawn(self._detach_later(number))

    async def _detach_later(self, number: int) -> None:
        """Detach a closed channel when the engine has routed the bytes that came before."""
        await asyncio.sleep(LINGER_TIME)
        self._detach(number)
        for table in (self._dropped, self._profiles, self._sent):
            table.pop(number, None)
        if not self._numbers and self.state == OPEN:
            self.state = LISTENING

    def _update_proofs(self) -> None:
        """Tell the link what its peers have proved; the engine knows it."""
        now, wall = monotonic(), time()
        for place in self._proofs.places(now):
            channel = self._channels[place.owner]
            if place.proof > Proof.SILENT:
                channel.last_valid = wall - (now - place.used_at)
            channel.is_authenticated = place.proof is Proof.AUTHENTICATED

    def _write(self, number: int, channel: Channel, packets: Sequence[bytes]) -> Sequence[bytes]:
        """Send packets; return those for which the channel has no room."""
        done = 0
        for count, chunk in _chunks(packets) if self._joins else ((1, packet) for packet in packets):
            if channel.closed:
                self._count_dropped(number, len(packets) - done)
                return ()
            if not channel.write(chunk):
                return packets[done:]
            done += count
            if number in self._profiles:
                packets_sent, bytes_sent = self._sent.get(number, (0, 0))
                self._sent[number] = packets_sent + count, bytes_sent + len(chunk)
        return ()

    def _count_dropped(self, number: int, count: int) -> None:
        if number in self._dropped:
            self._dropped[number] += count

    async def _send_summaries(self, interval: float) -> None:
        """Send the HIGH_LATENCY2 messages when they are due."""
        while True:
            due = [each.next_timeout() for each in self._profiles.values()]
            known = [each for each in due if each is not None]
            delay = min(known) - monotonic() if known else min(interval, 0.5)
            await asyncio.sleep(min(max(delay, 0.01), 0.5))
            for number, channel in self._channels.items():
                rest = self._write(number, channel, self._profiles[number].messages_to_send(monotonic()))
                self._count_dropped(number, len(rest))


def _peer_of(text: str) -> Peer | None:
    """Return the peer of a text such as `10.0.0.1:5760` or `[::1]:5760`; None for other peers."""
    host, _, port = text.rpartition(":")
    return Peer(host.strip("[]"), int(port)) if host and port.isascii() and port.isdecimal() else None


def _chunks(packets: Sequence[bytes]) -> Iterator[tuple[int, bytes]]:
    """Yield packets joined to chunks of at most `MAX_CHUNK` bytes, with the number of packets in each."""
    pending: list[bytes] = []
    size = 0
    for packet in packets:
        if pending and size + len(packet) > MAX_CHUNK:
            yield len(pending), b"".join(pending)
            pending, size = [], 0
        pending.append(packet)
        size += len(packet)
    if pending:
        yield len(pending), b"".join(pending)
