"""The follower of a live link: passes its data to an observer until the link ends or the time is up."""

from __future__ import annotations

import asyncio
import sys
from contextlib import asynccontextmanager
from time import monotonic
from typing import TYPE_CHECKING, Final

from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened, LinkDown
from mavstack.node.link_settings import link_keys
from mavstack.node.native_bytes import read_natively
from mavstack.node.signing_states import SigningStates

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Iterator, Sequence

    from mavstack.cli.watch.observer import Observer
    from mavstack.links import Link, LinkEvent
    from mavstack.security import SigningKey
    from mavstack.wire import Packet, Signing

#: Seconds within which bytes count as received together (in a replay: recorded together).
JOIN_TIME: Final = 0.001


class Follower:
    """Feeds an observer with the data of a link; `show` prints the packets."""

    def __init__(
        self, observer: Observer, show: Callable[[Sequence[Packet], float], None] | None = None
    ) -> None:
        self.observer = observer
        #: Problem of the link in words; empty if there is none.
        self.note = ""
        self.bytes = 0
        self.started = monotonic()
        #: The signing state of each open channel; None: the channel is unsigned.
        self.signings: dict[str, Signing | None] = {}
        self._key: SigningKey | None = None
        self._signing_states = SigningStates()
        self._closed_refusals = 0
        #: Called with the selected packets and their Unix time.
        self.show = show
        #: Awaited after each batch of events; it may slow down the link.
        self.after_batch: Callable[[], Awaitable[None]] | None = None
        self._shown = False

    @property
    def seconds(self) -> float:
        """Seconds since the link is followed."""
        return monotonic() - self.started

    @property
    def refused(self) -> int:
        """Packets that were refused because the key of the link did not sign them."""
        open_channels = sum(signing.refusals.total for signing in self.signings.values() if signing)
        return self._closed_refusals + open_channels

    async def follow(self, link: Link, seconds: float | None = None) -> None:
        """Follow an open link until it ends, at most for `seconds`."""
        self.started = monotonic()
        self._key = link_keys([link]).get(link)
        link.joins_datagrams = True
        try:
            async with asyncio.timeout(seconds) as deadline, read_natively(link, self.observer.dialect):
                async for events in link.batches():
                    now = monotonic()
                    for event in join_chunks(events):
                        self._event(event, now)
                    if self._shown:  # flush once per batch of events, not once per packet
                        self._shown = False
                        sys.stdout.flush()
                    await self._after_batch()
        except TimeoutError:
            if not deadline.expired():
                raise

    def _event(self, event: object, now: float) -> None:
        if type(event) is BytesReceived:
            self.bytes += len(event.data)
            before = self.observer.received
            packets = self.observer.receive(event.channel.name, event.data, now, time=event.time)
            if self.observer.received > before:
                # when the link is full, it keeps peers that sent a valid packet
                event.channel.last_valid = event.time
            self._print(packets, event.time)
        elif isinstance(event, ChannelOpened):
            self.note = ""
            self._open(event.channel.name)
        elif isinstance(event, ChannelClosed):
            time = event.channel.last_received
            self._print(self.observer.flush(event.channel.name, now, time=time), time)
            self._close(event.channel.name)
            self.note = f"{event.channel.name}: {event.reason}"
        elif isinstance(event, LinkDown):
            self.note = f"no connection: {event.reason}; next try in {event.retry_in:.0f} s"

    async def _after_batch(self) -> None:
        if self.after_batch is not None:
            await self.after_batch()

    def _print(self, packets: Sequence[Packet], time: float) -> None:
        if self.show is not None and packets:
            self.show(packets, time)
            self._shown = True

    def _open(self, name: str) -> None:
        signing = self._signing_states.create(self._key, len(self.signings) % 256, 0)
        self.signings[name] = signing
        self.observer.open(name, signing=signing)

    def _close(self, name: str) -> None:
        self.observer.close(name)
        signing = self.signings.pop(name, None)
        self._closed_refusals += signing.refusals.total if signing else 0


def join_chunks(events: Sequence[LinkEvent]) -> Iterator[LinkEvent]:
    """Join the bytes that a channel received within `JOIN_TIME`: parsing them together costs much less."""
    chunks: list[bytes] = []
    first: BytesReceived | None = None
    for event in events:
        if first is not None:
            if (
                type(event) is BytesReceived
                and event.channel is first.channel
                and event.time - first.time < JOIN_TIME
            ):
                chunks.append(event.data)
                continue
            yield first._replace(data=b"".join(chunks))
            first = None
        if type(event) is BytesReceived:
            first, chunks = event, [event.data]
        else:
            yield event
    if first is not None:
        yield first._replace(data=b"".join(chunks))


@asynccontextmanager
async def background_tasks(*jobs: Coroutine[object, object, None]) -> AsyncIterator[None]:
    """Run jobs while the block runs; an error in one of them ends the block."""
    try:
        async with asyncio.TaskGroup() as group:
            tasks = [group.create_task(job) for job in jobs]
            yield
            for task in tasks:
                task.cancel()
    except BaseExceptionGroup as errors:
        raise errors.exceptions[0] from None
