"""Sealed links: `sealed+udpin://`, `sealed+udpout://`, `sealed+tcpin://`, `sealed+tcpout://`, `sealed+serial://`.

A sealed link is the link behind the `+`, and authenticated encryption over each of its channels (see
`mavstack.security.sealed`); it needs the extra `secure`. `sealed+udp://` listens and `sealed+tcp://`
connects, as `udp:` and `tcp:` do. Both ends have either the key of `shared_key=` (a signing key by file or
name; another key is derived from it), or a `private_key=` of their own and the public keys of the others in
`peer=`. `hybrid=yes` and `cipher=` must be equal at both ends; nothing is negotiated.

udpout and tcpout begin handshakes, udpin and tcpin answer them, and the two ends of a serial link do both. A
channel opens when the first handshake is done; datagrams that are not authentic are dropped and counted.
Chunks that are written in one round of the event loop are joined to datagrams of up to `mtu` bytes. Over TCP
and serial ports datagrams are framed by COBS. Impairments act on the sealed datagrams, as a network does.
"""

from __future__ import annotations

import asyncio
import logging
import os
from collections import Counter
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError, LinkClosedError, LinkError, LinkURLError, SigningError
from mavstack.links.base import Link
from mavstack.links.channel import Channel
from mavstack.links.events import BytesReceived, ChannelClosed, ChannelOpened, LinkDown
from mavstack.links.registry import impaired_link
from mavstack.links.role_gate import RoleGate
from mavstack.links.scheme_table import SCHEMES
from mavstack.links.schemes.sealed import SEALED
from mavstack.links.url import LinkURL
from mavstack.security.key_store import find_key
from mavstack.security.sealed import Responder, SealConfig, Tunnel, cobs
from mavstack.security.sealed.keys import read_peers, read_private_key
from mavstack.security.sealed.session import OVERHEAD

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.links.channel import Data
    from mavstack.links.events import LinkEvent
    from mavstack.links.options import Options
    from mavstack.links.scheme import LinkScheme

#: Seconds between two checks of the timers of all tunnels.
TICK: Final = 0.1
#: Attempts without an answer after which a warning is logged.
WARN_ATTEMPTS: Final = 5
MAX_CHUNK: Final = 60_000
CIPHERS: Final = ("chacha20", "aes256")
#: Size of a shared key in bytes.
SECRET_SIZE: Final = 32
#: Maximum size of a datagram with joined packets: on the Internet, over streams, and over radios, where one
#: damaged byte costs the whole datagram.
_DATAGRAM_MTU: Final = 1200
_STREAM_MTU: Final = 8192
_DEVICE_MTU: Final = 320

_logger = logging.getLogger("mavstack.links")


class SealedChannel(Channel):
    """A channel whose bytes are sealed; it sends over a channel of the inner link."""

    def __init__(self, link: SealedLink, inner: Channel, tunnel: Tunnel) -> None:
        super().__init__(SEALED + inner.name, inner.peer, link.channel_closed)
        self._inner, self._tunnel = inner, tunnel
        self._loop = asyncio.get_running_loop()
        self._decoder = cobs.Decoder() if link.is_stream else None
        self._room = link.mtu - OVERHEAD
        self._waiting: list[Data] = []
        self._size = 0
        self.opened = self.warned = False

    async def drain(self) -> None:
        """Wait until the inner channel has room."""
        await self._inner.drain()

    def receive(self, data: bytes) -> list[bytes]:
        """Open received bytes; return the contents of authentic datagrams."""
        datagrams = [data] if self._decoder is None else self._decoder.feed(data)
        now, receive = self._loop.time(), self._tunnel.receive
        contents = [content for datagram in datagrams if (content := receive(datagram, now))]
        self.send_waiting()
        return contents

    def tick(self) -> None:
        """Run the timers of the tunnel."""
        self._tunnel.handle_timeout(self._loop.time())
        self.send_waiting()

    def send_waiting(self) -> None:
        """Send handshake messages and empty frames."""
        for datagram in self._tunnel.datagrams_to_send():
            self._transmit(datagram)

    @property
    def tunnel(self) -> Tunnel:
        """The tunnel to the peer."""
        return self._tunnel

    def send_bytes(self, data: Data) -> bool:
        """Send or queue a chunk."""
        size = len(data)
        if not self._tunnel.is_open or size > MAX_CHUNK:
            return False
        if self._size + size > self._room:
            self._flush()
        if not self._waiting:
            self._loop.call_soon(self._flush)
        self._waiting.append(data if type(data) is bytes else bytes(data))
        self._size += size
        return True

    def _flush(self) -> None:
        """Seal the waiting chunks as one datagram."""
        if self._waiting:
            count, content = len(self._waiting), b"".join(self._waiting)
            self._waiting.clear()
            self._size = 0
            datagram = self._tunnel.seal(content, self._loop.time())
            if not datagram or not self._transmit(datagram):
                self.counters.dropped_out += count

    def _transmit(self, datagram: bytes) -> bool:
        with suppress(LinkClosedError):
            return self._inner.write(datagram if self._decoder is None else cobs.encode(datagram))
        return False

    def close_transport(self) -> None:
        """Start closing the transport."""
        self._flush()
        self._inner.close()


class SealedLink(Link):
    """A link that seals another one.

    Args:
        url: The URL.
        options: Its options.
        inner: The link to seal; None: that of the scheme behind the `+`.
        answers: True for an end that answers handshakes; None: by the scheme.
    """

    def __init__(
        self, url: LinkURL, options: Options, inner: Link | None = None, *, answers: bool | None = None
    ) -> None:
        super().__init__(url, options)
        carrier = SCHEMES.get(url.scheme.removeprefix(SEALED))
        inner_url = LinkURL(carrier.name, url.host, url.port, url.path, url.options)
        self._inner = impaired_link(inner_url, options) if inner is None else inner
        # trust them: the handshake verifies a peer's address before packets are sent to it
        self._inner.trust_senders()
        #: Maximum size of a datagram with joined packets, in bytes.
        self.mtu = max(options.size("mtu", _default_mtu(carrier)), OVERHEAD + 1)
        self._config = _read_config(url, options)
        only_answers = carrier.listens if answers is None else answers
        self._initiates = not only_answers
        has_responder = only_answers or carrier.is_device
        self._responder = Responder(self._config, os.urandom) if has_responder else None
        if self._initiates and not carrier.is_device and not self._config.can_connect:
            raise LinkURLError(f"{url.redacted}: an end that connects needs one public key in peer=")
        #: True if the inner link carries a stream.
        self.is_stream = carrier.is_stream
        self._roles = RoleGate(url, options)
        self._sealed: dict[Channel, SealedChannel] = {}
        self._past_refusals: Counter[str] = Counter()

    @property
    def address(self) -> tuple[str, int] | None:
        """Host and port on which the inner link listens, or None."""
        return self._inner.address

    @property
    def refusals(self) -> Counter[str]:
        """Datagrams that were not accepted, by reason, such as forged, replayed or wrong cookie."""
        tunnels = (channel.tunnel.refusals for channel in self._sealed.values())
        answered = self._responder.refusals if self._responder is not None else Counter[str]()
        return sum(tunnels, self._past_refusals + answered)

    def channel_closed(self, channel: Channel, reason: str) -> None:
        """Remove a closed channel."""
        self.inbox.remove_channel(channel, reason)

    async def open_transport(self) -> None:
        """Open the transport of the link."""
        await self._inner.open()
        for channel in self._inner.channels:
            self._wrap(channel)
        self.spawn(self._follow())
        self.spawn(self._run_timers())

    async def _follow(self) -> None:
        await self._inner.read(self._handle)
        self.inbox.end()

    async def _run_timers(self) -> None:
        while True:
            for channel in tuple(self._sealed.values()):
                channel.tick()
                if not (channel.opened or channel.warned) and channel.tunnel.unanswered >= WARN_ATTEMPTS:
                    self._warn(channel)
            await asyncio.sleep(TICK)

    def _warn(self, channel: SealedChannel) -> None:
        channel.warned = True
        _logger.warning(
            "%s: no answer to %d handshakes with %s: does the other end use the same keys and options?",
            self.url.redacted, WARN_ATTEMPTS, channel.peer,
        )  # fmt: skip

    def _handle(self, events: Sequence[LinkEvent]) -> None:
        for event in events:
            match event:
                case BytesReceived(inner, data, time):
                    self._receive(inner, data, time)
                case ChannelOpened(inner):
                    self._wrap(inner)
                case ChannelClosed(inner, reason):
                    self._unwrap(inner, reason)
                case LinkDown(reason, retry_in):
                    self.inbox.report_down(reason, retry_in)

    def _receive(self, inner: Channel, data: bytes, time: float) -> None:
        channel = self._sealed.get(inner)
        if channel is None or channel.closed:
            return
        contents = channel.receive(data)
        if not channel.opened and channel.tunnel.is_open:
            channel.opened = True
            channel.identity = channel.tunnel.peer
            channel.role_filter = self._roles.filter_of(channel.identity)
            self.inbox.add_channel(channel)
        for content in contents:
            inner.last_valid = channel.last_received = time
            inner.is_authenticated = True
            if allowed := channel.allowed(content):
                self.inbox.deliver(channel, allowed, time)

    def _wrap(self, inner: Channel) -> None:
        if inner not in self._sealed:
            tunnel = Tunnel(
                self._config,
                initiates=self._initiates,
                responder=self._responder,
                address=inner.peer.encode() if not self.is_stream else b"",
            )
            self._sealed[inner] = channel = SealedChannel(self, inner, tunnel)
            channel.tick()

    def _unwrap(self, inner: Channel, reason: str) -> None:
        channel = self._sealed.pop(inner, None)
        if channel is not None:
            self._past_refusals += channel.tunnel.refusals
            channel.close(reason)

    async def stop_transport(self) -> None:
        """Stop accepting peers and bytes."""
        for channel in self._sealed.values():
            channel.close("link closed")
        await self._inner.close()


def _default_mtu(carrier: LinkScheme) -> int:
    if carrier.is_device:
        return _DEVICE_MTU
    return _STREAM_MTU if carrier.is_stream else _DATAGRAM_MTU


def _read_config(url: LinkURL, options: Options) -> SealConfig:
    shared, private, peer = options.text("shared_key"), options.text("private_key"), options.text("peer")
    secret = options.parsed("secret", _read_secret, "64 hexadecimal digits")
    hybrid = options.flag("hybrid", default=False)
    aes = options.choice("cipher", CIPHERS) == "aes256"
    if sum(map(bool, (shared, secret, private))) != 1 or bool(private) != bool(peer):
        raise LinkURLError(
            f"{url.redacted}: a sealed link needs a key: shared_key=NAME at both ends, or private_key=NAME "
            "of its own and peer= with the public key of the other end"
        )
    try:
        if secret is not None:
            return SealConfig.shared(secret, hybrid=hybrid, aes=aes)
        if shared:
            return SealConfig.shared(find_key(shared).secret_bytes(), hybrid=hybrid, aes=aes)
        return SealConfig.pinned(read_private_key(private), read_peers(peer), hybrid=hybrid, aes=aes)
    except (SigningError, InvalidArgumentError) as error:
        raise LinkError(f"cannot open {url.redacted}: {error}") from None


def _read_secret(text: str) -> bytes:
    """Return the shared key of its digits; raises `ValueError`."""
    secret = bytes.fromhex(text)
    if len(secret) != SECRET_SIZE:
        raise ValueError(text)
    return secret
