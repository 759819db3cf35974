"""Links to a fleet on Zenoh: `zenoh://router.example:7447/mavstack`.

Each vehicle that a gateway (`mav bridge zenoh`) serves is a channel. It opens when the liveliness token of
the vehicle appears, and closes when the token is gone, with the vehicle, its gateway, or the network between.
Written packets go to the gateway, which passes them to the vehicle if it allows control. Zenoh connects again
by itself when the router was away.
"""

from __future__ import annotations

import asyncio
from time import time
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.sink import Handoff
from mavstack.bridges.core.zenoh_session import (
    OPEN_TIMEOUT,
    SessionOptions,
    close_session,
    direct,
    open_session,
    zenoh_module,
)
from mavstack.bridges.zenoh.keys import (
    DEFAULT_PREFIX,
    VehicleKeys,
    checked_name,
    checked_prefix,
    parse_alive,
    vehicle_of,
)
from mavstack.errors import InvalidArgumentError, LinkURLError
from mavstack.links.base import Link
from mavstack.links.channel import Channel, Data

if TYPE_CHECKING:
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

#: Maximum number of samples that wait for the event loop; the oldest are dropped first.
MAX_WAITING: Final = 10_000


class ZenohChannel(Channel):
    """One vehicle of the fleet."""

    def __init__(self, link: ZenohLink, name: str, publisher: Any) -> None:
        super().__init__(f"zenoh {name}", name, link.channel_closed)
        #: The gateways that serve the vehicle.
        self.gateways: set[str] = set()
        self._publisher = publisher

    def send_bytes(self, data: Data) -> bool:
        """Send a chunk; a network that is full loses it."""
        if self._publisher is None:
            return False
        self._publisher.put(bytes(data))
        return True

    def close_transport(self) -> None:
        """Withdraw the publisher."""
        publisher, self._publisher = self._publisher, None
        if publisher is not None:
            publisher.undeclare()


class ZenohLink(Link):
    """A link to the vehicles of a fleet."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._zenoh = zenoh_module("a link over Zenoh")
        try:
            self._prefix = checked_prefix(url.path.strip("/") or DEFAULT_PREFIX)
            vehicle = options.text("vehicle")
            self._vehicle = checked_name(vehicle, "the option vehicle") if vehicle else "*"
        except InvalidArgumentError as error:
            raise LinkURLError(f"{url.redacted}: {error}") from None
        self._options = _session_options(url, options)
        self._session: Any = None
        self._kept: list[Any] = []
        self._by_name: dict[str, ZenohChannel] = {}

    async def open_transport(self) -> None:
        """Connect to the router, and follow the vehicles."""
        loop = asyncio.get_running_loop()
        tokens: Handoff[tuple[str, bool]] = Handoff(loop, self._on_token, MAX_WAITING)
        samples: Handoff[tuple[str, bytes]] = Handoff(loop, self._on_sample, MAX_WAITING)
        self._samples = samples
        self._session = await open_session(self._zenoh, self._options)
        keys, zenoh = VehicleKeys(self._prefix, self._vehicle), self._zenoh
        put = zenoh.SampleKind.PUT
        self._kept = [
            self._session.declare_subscriber(
                keys.frames_out,
                direct(zenoh, lambda sample: samples.put((str(sample.key_expr), bytes(sample.payload)))),
            ),
            self._session.liveliness().declare_subscriber(
                keys.alive("*"),
                direct(zenoh, lambda sample: tokens.put((str(sample.key_expr), sample.kind == put))),
                history=True,
            ),
        ]

    async def stop_transport(self) -> None:
        """Stop following the vehicles."""
        for each in self._kept:
            each.undeclare()
        self._kept.clear()

    async def release_transport(self) -> None:
        """Disconnect."""
        session, self._session = self._session, None
        if session is not None:
            await close_session(session)

    @property
    def dropped(self) -> int:
        """Samples that were dropped on their way into the event loop."""
        return self._samples.dropped

    def channel_closed(self, channel: Channel, reason: str) -> None:
        """Remove a closed channel."""
        self._by_name.pop(channel.peer, None)
        self.inbox.remove_channel(channel, reason)

    def _on_token(self, token: tuple[str, bool]) -> None:
        key, exists = token
        found = parse_alive(self._prefix, key)
        if found is None or self._closed:
            return
        name, gateway = found
        channel = self._by_name.get(name)
        if exists:
            (channel or self._open_channel(name)).gateways.add(gateway)
        elif channel is not None:
            channel.gateways.discard(gateway)
            if not channel.gateways:
                channel.close("its gateway does not show it any more")

    def _open_channel(self, name: str) -> ZenohChannel:
        zenoh = self._zenoh
        publisher = self._session.declare_publisher(
            VehicleKeys(self._prefix, name).frames_in,
            congestion_control=zenoh.CongestionControl.DROP,
            priority=zenoh.Priority.INTERACTIVE_HIGH,
            express=True,
        )
        channel = self._by_name[name] = ZenohChannel(self, name, publisher)
        self.inbox.add_channel(channel)
        return channel

    def _on_sample(self, sample: tuple[str, bytes]) -> None:
        key, data = sample
        channel = self._by_name.get(vehicle_of(self._prefix, key))
        if channel is None:  # the liveliness token of the vehicle has not arrived yet
            self.inbox.drop()
            return
        channel.last_received = now = time()
        self.inbox.deliver(channel, data, now)


def _session_options(url: LinkURL, options: Options) -> SessionOptions:
    ca, certificate, key = options.text("ca"), options.text("cert"), options.text("key")
    if bool(certificate) != bool(key):
        raise LinkURLError(f"{url.redacted}: the options cert and key need each other")
    host = f"[{url.host}]" if ":" in url.host else url.host
    scheme = "tls" if ca or certificate else "tcp"
    timeout = options.seconds("timeout", OPEN_TIMEOUT)
    return SessionOptions(
        (f"{scheme}/{host}:{url.port}",), ca=ca, certificate=certificate, private_key=key, timeout=timeout
    )
