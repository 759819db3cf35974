"""A session of Zenoh as the gateway uses it: declarations whose callbacks run in the event loop."""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.sink import Handoff
from mavstack.bridges.core.zenoh_session import (
    RouterReports,
    close_session,
    direct,
    open_session,
    zenoh_module,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from mavstack.bridges.core.zenoh_session import SessionOptions

logger = logging.getLogger("mavstack.bridges")
#: Maximum number of samples and queries that wait for the event loop; the oldest are dropped first.
MAX_WAITING: Final = 10_000
#: Maximum number of queries that are answered at the same time; further ones wait.
MAX_QUERIES: Final = 256


class Bus:
    """A session.

    Args:
        options: How it connects.
        gateway: The name of this gateway.
    """

    def __init__(self, options: SessionOptions, gateway: str) -> None:
        self.zenoh = zenoh_module("a fleet over Zenoh")
        self.gateway = gateway
        self._options = options
        self._session: Any = None
        self._tasks: set[asyncio.Task[None]] = set()
        self._slots = asyncio.Semaphore(MAX_QUERIES)

    async def open(self) -> None:
        """Connect.

        Raises:
            LinkError: No router answers, or a certificate cannot be used.
        """
        self._calls: Handoff[tuple[Callable[[Any], None], Any]] = Handoff(
            asyncio.get_running_loop(), _call, MAX_WAITING
        )
        self._session = await open_session(self.zenoh, self._options)
        self._reports = RouterReports(self.zenoh, self._session, self._options.routers)

    async def close(self) -> None:
        """Disconnect. Idempotent."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        session, self._session = self._session, None
        if session is not None:
            self._reports.end()
            await close_session(session)

    @property
    def dropped(self) -> int:
        """Samples and queries that were dropped on their way into the event loop."""
        return self._calls.dropped

    def publisher(self, key: str, matching: Callable[[bool], None] | None = None) -> Any:
        """Declare a publisher; `matching` is called with whether it has subscribers, when that changes."""
        zenoh = self.zenoh
        declared = self._session.declare_publisher(key, congestion_control=zenoh.CongestionControl.DROP)
        if matching is not None:
            put = self._calls.put

            def changed(status: Any) -> None:
                put((matching, status.matching))

            declared.declare_matching_listener(direct(zenoh, changed))
            if declared.matching_status.matching:
                matching(True)
        return declared

    def latched_publisher(self, key: str) -> Any:
        """Declare a publisher whose last sample late subscribers get."""
        zenoh = self.zenoh
        return zenoh.ext.declare_advanced_publisher(
            self._session,
            key,
            cache=zenoh.ext.CacheConfig(1),
            publisher_detection=True,
            congestion_control=zenoh.CongestionControl.DROP,
        )

    def subscriber(self, key: str, receive: Callable[[Any], None]) -> Any:
        """Subscribe; each sample is passed to a function."""
        put = self._calls.put
        return self._session.declare_subscriber(
            key, direct(self.zenoh, lambda sample: put((receive, sample)))
        )

    def queryable(self, key: str, answer: Callable[[Any], Coroutine[Any, Any, None]]) -> Any:
        """Answer queries; each runs in a task."""
        put = self._calls.put

        def begin(query: Any) -> None:
            task = asyncio.get_running_loop().create_task(self._answer(answer, query))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

        return self._session.declare_queryable(
            key, direct(self.zenoh, lambda query: put((begin, query))), complete=True
        )

    def token(self, key: str) -> Any:
        """Declare a liveliness token."""
        return self._session.liveliness().declare_token(key)

    def liveliness(self, key: str, changed: Callable[[str, bool], None]) -> Any:
        """Follow liveliness tokens: their keys, and whether they exist; those that exist come first."""
        put, zenoh = self._calls.put, self.zenoh

        def receive(sample: Any) -> None:
            put((lambda found: changed(*found), (str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT)))

        return self._session.liveliness().declare_subscriber(key, direct(zenoh, receive), history=True)

    def put(self, key: str, data: bytes, encoding: str) -> None:
        """Put a sample without a declaration."""
        drop = self.zenoh.CongestionControl.DROP
        self._session.put(key, data, encoding=encoding, congestion_control=drop)

    def undeclare(self, declared: Any) -> None:
        """Withdraw a declaration; nothing happens if the session is closed."""
        with suppress(self.zenoh.ZError):
            declared.undeclare()

    async def _answer(self, answer: Callable[[Any], Coroutine[Any, Any, None]], query: Any) -> None:
        async with self._slots:
            with query, suppress(self.zenoh.ZError):
                try:
                    await answer(query)
                except Exception:
                    logger.exception("answering a query on Zenoh failed")
                    query.reply_err(b'{"ok":false,"reason":"the gateway failed; see its log"}')


def _call(item: tuple[Callable[[Any], None], Any]) -> None:
    function, argument = item
    function(argument)
