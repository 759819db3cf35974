"""Links whose channels are connections, each read by a task of its own until the peer is gone.

A `ServerLink` accepts up to `max_peers` of them. A `ClientLink` has one at a time and connects again when
it is lost: after `retry` seconds, then twice as long each time up to `retry_limit`, the same delays on
every run. A connection over which bytes came starts the delays anew; one that only opens does not, so
that a peer which hangs up at once is not called in a tight loop.

The first attempt is different: `open` raises when it fails, because a wrong address and a missing device are
mostly mistakes of the person who typed them. `wait=yes` keeps trying instead; `reconnect=no` tries only once.
"""

from __future__ import annotations

import asyncio
from abc import abstractmethod
from dataclasses import dataclass
from itertools import count
from typing import TYPE_CHECKING

from mavstack.errors import LinkError
from mavstack.links.base import Link
from mavstack.links.channel import Channel
from mavstack.links.explain import explain

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.links.inbox import Inbox
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

LINGER = 1.0  # seconds that closing a link waits for what is still queued


@dataclass(frozen=True, slots=True)
class Backoff:
    """How long to wait before the next attempt: doubling from `first` seconds up to `limit`."""

    first: float
    limit: float

    def delays(self) -> Iterator[float]:
        """All delays from the first on."""
        for attempt in count():
            yield min(self.first * 2.0 ** min(attempt, 64), self.limit)


class Connection(Channel):
    """A channel that its link reads by a task."""

    @abstractmethod
    async def pump(self, inbox: Inbox) -> str:
        """Move received bytes into the inbox until the end, and return the reason of the end."""

    @abstractmethod
    async def wait_closed(self) -> None:
        """After `close`, wait until what was queued is sent."""

    @abstractmethod
    def abort(self) -> None:
        """Let go at once, whatever is queued."""


class ConnectionLink(Link):
    """What servers and clients share."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._served: set[Connection] = set()

    def _begin(self, connection: Connection) -> None:
        """Take a connection as a channel; `_serve` follows."""
        self._served.add(connection)
        self._inbox.opened(connection)

    def _patience(self) -> float:
        return LINGER if self._served else 0

    async def _serve(self, connection: Connection) -> str:
        """Read one connection until its end, and return the reason."""
        reason = "link closed"
        try:
            reason = await connection.pump(self._inbox)
            if connection.closed:  # by this side: what was written before still goes out
                await connection.wait_closed()
        finally:
            connection.close(reason)
            connection.abort()
            self._served.discard(connection)
        return reason


class ServerLink(ConnectionLink):
    """Accepts connections, each a channel."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._max_peers = options.whole("max_peers", 64)

    def _admit(self, connection: Connection) -> bool:
        """Take a new connection as a channel, unless there are too many or nobody reads the events."""
        if self._closed or len(self.channels) >= self._max_peers or self._inbox.full:
            connection.close("too many peers")
            connection.abort()
            return False
        self._begin(connection)
        return True

    async def _serve_task(self, connection: Connection) -> None:
        await self._serve(connection)


class ClientLink(ConnectionLink):
    """Keeps one connection alive."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._reconnect = options.flag("reconnect", default=True)
        self._patient = options.flag("wait", default=False)
        shortest, longest = options.seconds("retry", 0.25), options.seconds("retry_limit", 10.0)
        self._backoff = Backoff(max(shortest, 0.001), max(longest, 0.001))

    @abstractmethod
    async def _connect(self) -> Connection:
        """Make one attempt; raises `OSError` or `LinkError`."""

    async def _open(self) -> None:
        self._spawn(self._keep_alive(None if self._patient else await self._attempt()))

    async def _attempt(self) -> Connection:
        try:
            connection = await self._connect()
        except OSError as error:
            raise explain(self.url, error) from error
        self._begin(connection)
        return connection

    async def _keep_alive(self, connection: Connection | None) -> None:
        delays = self._backoff.delays()
        while True:
            try:
                connection = connection or await self._attempt()
            except LinkError as error:
                reason = str(error)
            else:
                reason = await self._serve(connection)
                if self._closed or not self._reconnect:
                    break
                if connection.counters.bytes_in:
                    delays = self._backoff.delays()
                connection = None
            delay = next(delays)
            self._inbox.down(reason, delay)
            await asyncio.sleep(delay)
        self._inbox.end()
