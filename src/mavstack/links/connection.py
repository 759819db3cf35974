"""Links with connections: each channel is read by a task of its own until the connection ends.

A `ServerLink` accepts up to `max_peers` connections (see `admission`). A `ClientLink` has one connection and
reconnects when it is lost: after `retry` seconds, doubling the delay each time up to `retry_limit`, without
random variation. A connection that received bytes resets the delay; one that only opened does not, so that a
peer which closes immediately causes no tight loop of reconnections.

If the first attempt fails, `open` raises, because the usual cause is a wrong address or a missing device.
With `wait=yes` it keeps trying instead; with `reconnect=no` there is only one attempt.
"""

from __future__ import annotations

import asyncio
from abc import abstractmethod
from dataclasses import dataclass
from itertools import count
from time import time
from typing import TYPE_CHECKING

from mavstack.errors import LinkError
from mavstack.links.admission import PeerAdmission
from mavstack.links.base import Link
from mavstack.links.channel import Channel
from mavstack.links.os_errors import open_error

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.links.inbox import Inbox
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

CLOSE_TIMEOUT = 1.0  # seconds for which closing a link waits for queued bytes


@dataclass(frozen=True, slots=True)
class Backoff:
    """Delays before reconnection attempts, in seconds: doubling from `first` up to `limit`."""

    first: float
    limit: float

    def delays(self) -> Iterator[float]:
        """Yield all delays, endlessly."""
        for attempt in count():
            yield min(self.first * 2.0 ** min(attempt, 64), self.limit)


class ConnectionChannel(Channel):
    """A channel over one connection, read by a task of its link."""

    @abstractmethod
    async def receive_all(self, inbox: Inbox) -> str:
        """Put received bytes into the inbox until the connection ends; return the reason why it ended."""

    @abstractmethod
    async def wait_closed(self) -> None:
        """After `close`, wait until all queued bytes are sent."""

    @abstractmethod
    def abort(self) -> None:
        """Drop the connection and all queued bytes."""


class ConnectionLink(Link):
    """Base of server and client links."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._active: set[ConnectionChannel] = set()

    def _add_channel(self, connection: ConnectionChannel) -> None:
        """Add a connection as a channel; the caller then runs `_serve`."""
        self._active.add(connection)
        self.inbox.add_channel(connection)

    def close_timeout(self) -> float:
        """Return for how many seconds queued bytes may still be sent."""
        return CLOSE_TIMEOUT if self._active else 0

    async def _serve(self, connection: ConnectionChannel) -> str:
        """Read one connection until it ends; return the reason why it ended."""
        reason = "link closed"
        try:
            reason = await connection.receive_all(self.inbox)
            if connection.closed:  # closed by this side: bytes that were written before are still sent
                await connection.wait_closed()
        finally:
            connection.close(reason)
            connection.abort()
            self._active.discard(connection)
        return reason


class ServerLink(ConnectionLink):
    """A link that accepts connections, each of which is a channel."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        #: Maximum number of connections.
        self.max_peers = options.integer("max_peers", 64)
        self._admission = PeerAdmission(self.max_peers)

    def _admit(self, connection: ConnectionChannel) -> bool:
        """Add a new connection as a channel, unless there are too many peers or the receive queue is full."""
        is_full = self._closed or self.inbox.full
        if self.before_choice is not None and len(self.channels) >= self.max_peers:
            self.before_choice()
        if is_full or not self._admission.admit(connection.host, self.channels, time()):
            connection.close("too many peers")
            connection.abort()
            return False
        self._add_channel(connection)
        return True

    async def _serve_task(self, connection: ConnectionChannel) -> None:
        await self._serve(connection)


class ClientLink(ConnectionLink):
    """A link that connects, and reconnects when the connection is lost.

    Attributes:
        reconnect: Reconnect after a lost connection.
        wait_for_peer: Keep trying if the first attempt fails.
        backoff: The delays before further attempts.
    """

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self.reconnect = options.flag("reconnect", default=True)
        self.wait_for_peer = options.flag("wait", default=False)
        first, limit = options.seconds("retry", 0.25), options.seconds("retry_limit", 10.0)
        self.backoff = Backoff(max(first, 0.001), max(limit, 0.001))

    @abstractmethod
    async def _connect(self) -> ConnectionChannel:
        """Make one attempt to connect; raises `OSError` or `LinkError`."""

    async def open_transport(self) -> None:
        """Open the transport of the link."""
        self.spawn(self._maintain_connection(None if self.wait_for_peer else await self._attempt()))

    async def _attempt(self) -> ConnectionChannel:
        try:
            connection = await self._connect()
        except OSError as error:
            raise open_error(self.url, error) from error
        self._add_channel(connection)
        return connection

    async def _maintain_connection(self, connection: ConnectionChannel | None) -> None:
        delays = self.backoff.delays()
        while True:
            try:
                connection = connection or await self._attempt()
            except LinkError as error:
                reason = str(error)
            else:
                reason = await self._serve(connection)
                if self._closed or not self.reconnect:
                    break
                if connection.counters.bytes_in:
                    delays = self.backoff.delays()
                connection = None
            delay = next(delays)
            self.inbox.report_down(reason, delay)
            await asyncio.sleep(delay)
        self.inbox.end()
