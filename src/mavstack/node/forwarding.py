"""Forwarding: other programs sit behind this node and hear and reach what it hears and reaches.

    async with Forwarding(node) as forwarding:
        await forwarding.add("udpout://127.0.0.1:14551")

Every packet that the node hears goes to every output as it came; every packet that comes from an output goes,
as it came, to where it is addressed. Packets are cut out of the bytes, so that a stream and datagrams can be
on either side and nobody's packets get into each other; what is not MAVLink is left out. What one output
sends does not reach another, nor the program's own subscriptions.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.errors import LinkClosedError, LinkError, MavstackError
from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened, Link, open_link
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType
    from typing import Self

    from mavstack.links import Channel, LinkEvent
    from mavstack.node.node import Node
    from mavstack.wire import Packet


@dataclass(eq=False)
class Output:
    """One link that is forwarded to, and what went over it, in packets."""

    link: Link
    sent: int = 0
    received: int = 0
    parsers: dict[Channel, Parser] = field(default_factory=dict)
    task: asyncio.Task[None] | None = None

    @property
    def url(self) -> str:
        """Where it leads."""
        return str(self.link.url)

    @property
    def peers(self) -> int:
        """How many are on it now."""
        return len(self.parsers)


class Forwarding:
    """The outputs of a node; they can be added and removed while it runs."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._outputs: list[Output] = []
        self._listening = node.add_packet_listener(None, self._hear)

    @property
    def outputs(self) -> Sequence[Output]:
        """Those that are open, in the order in which they were added."""
        return tuple(self._outputs)

    async def add(self, link: str | Link) -> Output:
        """Forward to a link from now on; raises `LinkError` if it cannot be opened."""
        output = Output(open_link(link) if isinstance(link, str) else link)
        if any(output.url == other.url for other in self._outputs):
            raise LinkError(f"{output.url} is an output already")
        await output.link.open()
        output.task = asyncio.get_running_loop().create_task(self._read(output))
        self._outputs.append(output)
        await asyncio.sleep(0)  # who is there already is heard of
        return output

    async def remove(self, which: str | int) -> Output:
        """Forward no more to a link, by its URL or its place among `outputs`."""
        output = self._find(which)
        self._outputs.remove(output)
        await self._shut(output)
        return output

    async def close(self) -> None:
        """Forward nothing more. Closing twice does nothing."""
        self._listening.close()
        outputs, self._outputs = self._outputs, []
        for output in outputs:
            await self._shut(output)

    def _find(self, which: str | int) -> Output:
        if isinstance(which, int) and 0 <= which < len(self._outputs):
            return self._outputs[which]
        for output in self._outputs:
            if output.url == str(which):
                return output
        known = ", ".join(output.url for output in self._outputs) or "none"
        raise MavstackError(f"{which} is not an output; outputs: {known}")

    async def _shut(self, output: Output) -> None:
        if output.task is not None:
            output.task.cancel()
            await asyncio.gather(output.task, return_exceptions=True)
        await output.link.close()

    def _hear(self, packet: Packet) -> None:
        for output in self._outputs:
            for channel in tuple(output.parsers):
                try:
                    output.sent += channel.write(packet.raw)
                except LinkClosedError:
                    continue  # its ChannelClosed is on the way

    async def _read(self, output: Output) -> None:
        async for event in output.link:
            self._take(output, event)

    def _take(self, output: Output, event: LinkEvent) -> None:
        match event:
            case ChannelOpened(channel):
                output.parsers[channel] = Parser(self._node.engine.dialect)
            case ChannelClosed(channel):
                output.parsers.pop(channel, None)
            case BytesReceived(channel, data):
                for packet in output.parsers[channel].feed(data):
                    output.received += 1
                    if self._node.is_open:
                        self._node.forward(packet)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()
