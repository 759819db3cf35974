"""Impaired links: any link with loss, latency and so on, for tests.

They are opened by a URL with options, such as `udpout://host:port?loss=0.1&latency=200ms&seed=7`, or by
`impair(link, …)`. Each direction of a channel passes through its own `Flow` (see `impairment`), so a round
trip has twice the latency. A chunk that the bandwidth's queue refuses counts as dropped by the channel; a
chunk lost in transit is counted in `stats` only, because a real radio does not report it either. The channel
of the inner link is wrapped: the counters of the outer channel count the bytes that the program wrote and
received.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from itertools import count
from typing import TYPE_CHECKING

from mavstack.errors import LinkClosedError
from mavstack.links.base import Link
from mavstack.links.channel import Channel, Counters, Data
from mavstack.links.events import BytesReceived, ChannelClosed, ChannelOpened, LinkDown, LinkEvent
from mavstack.links.impairment import Flow, FlowStats, Impairment
from mavstack.links.options import Options

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links.inbox import Inbox


class FlowDriver:
    """Runs a flow by the clock of the event loop, and passes arriving chunks to a callback."""

    def __init__(self, flow: Flow, deliver: Callable[[bytes], object]) -> None:
        self.flow = flow
        self._deliver = deliver
        self._loop = asyncio.get_running_loop()
        self._timer: asyncio.TimerHandle | None = None

    def send(self, data: bytes) -> bool:
        """Send a chunk through the flow; without delay it arrives immediately."""
        accepted = self.flow.send(data, self._loop.time())
        self._run()
        return accepted

    def stop(self) -> None:
        """Discard the chunks in transit."""
        if self._timer is not None:
            self._timer.cancel()

    def _run(self) -> None:
        self.stop()
        for data in self.flow.receive(self._loop.time()):
            self._deliver(data)
        due = self.flow.next_timeout()
        self._timer = None if due is None else self._loop.call_at(due, self._run)


class ImpairedChannel(Channel):
    """A channel with a flow in each direction."""

    def __init__(self, inner: Channel, inbox: Inbox, outgoing: Flow, incoming: Flow) -> None:
        super().__init__(inner.name, inner.peer, inbox.remove_channel)
        self.request = inner.request
        self.identity = inner.identity
        self.role_filter = inner.role_filter
        self._inner = inner
        self.inbox = inbox
        self._outgoing = FlowDriver(outgoing, self._forward)
        self._incoming = FlowDriver(incoming, self._arrive)
        self._clock_offset = 0.0

    @property
    def stats(self) -> tuple[FlowStats, FlowStats]:
        """Statistics of the outgoing and the incoming flow."""
        return self._outgoing.flow.stats, self._incoming.flow.stats

    def receive(self, event: BytesReceived) -> None:
        """Pass an event of the inner channel through the incoming flow; its time is delayed too."""
        self._clock_offset = event.time - asyncio.get_running_loop().time()
        if not self._incoming.send(event.data):
            self.counters.dropped_in += 1

    async def drain(self) -> None:
        """Wait until the inner channel has room."""
        await self._inner.drain()

    def send_bytes(self, data: Data) -> bool:
        """Send or queue a chunk."""
        return self._outgoing.send(bytes(data))

    def _forward(self, data: bytes) -> None:
        with suppress(LinkClosedError):
            self._inner.write(data)

    def _arrive(self, data: bytes) -> None:
        self.inbox.offer(self, data, self._clock_offset + asyncio.get_running_loop().time())

    def close_transport(self) -> None:
        """Start closing the transport."""
        self._outgoing.stop()
        self._incoming.stop()
        self._inner.close()


class ImpairedLink(Link):
    """A wrapper around another link, which it opens and closes."""

    logged = False

    def __init__(self, inner: Link, outgoing: Impairment, incoming: Impairment) -> None:
        super().__init__(inner.url, Options(inner.url))
        self._inner = inner
        self._models = outgoing, incoming
        self._numbers = count()
        self._channels: dict[Channel, ImpairedChannel] = {}

    @property
    def address(self) -> tuple[str, int] | None:
        """Host and port on which the inner link listens, or None."""
        return self._inner.address

    @property
    def counters(self) -> Counters:
        """Total counters of all channels, including chunks dropped by the inner link."""
        inner = self._inner.counters
        return super().counters + Counters(dropped_in=inner.dropped_in, dropped_out=inner.dropped_out)

    def trust_senders(self) -> None:
        """Send everything to new peers at once; call it before `open`."""
        self._inner.trust_senders()

    async def open_transport(self) -> None:
        """Open the transport of the link."""
        await self._inner.open()
        for channel in self._inner.channels:  # also report the channels that are open from the start
            self._wrap(channel)
        self.spawn(self._follow())

    async def _follow(self) -> None:
        async for event in self._inner:
            self._handle(event)
            await self.inbox.wait_for_room()
        self.inbox.end()

    def _handle(self, event: LinkEvent) -> None:
        match event:
            case BytesReceived(channel):
                if channel in self._channels:
                    self._channels[channel].receive(event)
            case ChannelOpened(channel):
                if channel not in self._channels:
                    self._wrap(channel)
            case ChannelClosed(channel, reason):
                self._channels.pop(channel).close(reason)
            case LinkDown(reason, retry_in):
                self.inbox.report_down(reason, retry_in)

    def _wrap(self, inner: Channel) -> None:
        wrapper = self._new_channel(inner, next(self._numbers))
        self._channels[inner] = wrapper
        self.inbox.add_channel(wrapper)

    def _new_channel(self, inner: Channel, number: int) -> ImpairedChannel:
        outgoing, incoming = self._models
        return ImpairedChannel(
            inner, self.inbox, Flow(outgoing, f"{number} out"), Flow(incoming, f"{number} in")
        )

    async def stop_transport(self) -> None:
        """Stop accepting peers and bytes."""
        await self._inner.close()


def impair(link: Link, impairment: Impairment, incoming: Impairment | None = None) -> Link:
    """Wrap a link that is not open yet, so that its channels are impaired.

    Args:
        link: The link; the wrapper opens and closes it.
        impairment: The impairment of sent bytes.
        incoming: The impairment of received bytes; None for that of sent bytes.

    Returns:
        The wrapped link.
    """
    return ImpairedLink(link, impairment, incoming or impairment)
