"""Forwarding: other programs share the links of a node.

    async with Forwarding(node) as forwarding:
        await forwarding.add("udpout://127.0.0.1:14551")

Packets go where the router sends them (`mavstack.router`), with the same table of learned routes: a packet
without a target to all outputs and to the links of the node, one with a target to those on which its target
was heard, and none back to where it came from. The links of the node are one place: packets are not passed
from one of them to another. A packet that an output sends back is dropped.

Packets stay as they are. Bytes are split into packets, so that streams and datagrams can be on either side
and packets never interleave; bytes that are not MAVLink are dropped. Packets from outputs do not reach the
program's own subscriptions. SETUP_SIGNING is never forwarded, in no direction, because it carries a signing
key in the clear; nor is RADIO_STATUS, which is about one link.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field
from time import monotonic
from typing import TYPE_CHECKING

from mavstack._core import PacketRouter
from mavstack.errors import InvalidArgumentError, LinkClosedError, LinkError, LinkURLError
from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened, Link, open_link
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType
    from typing import Self

    from mavstack.links import Channel, LinkEvent
    from mavstack.node.node import Node
    from mavstack.wire import Packet


@dataclass(frozen=True, slots=True)
class OutputChannel:
    """A peer of an output: its port in the routes, and the parser of its bytes."""

    port: int
    parser: Parser


@dataclass(eq=False)
class Output:
    """A link that packets are forwarded to, with its counters in packets."""

    link: Link
    sent: int = 0
    received: int = 0
    channels: dict[Channel, OutputChannel] = field(default_factory=dict)
    task: asyncio.Task[None] | None = None

    @property
    def url(self) -> str:
        """The URL of the link."""
        return str(self.link.url)

    @property
    def peers(self) -> int:
        """The number of open channels of the link."""
        return len(self.channels)


class Forwarding:
    """The outputs of a node; they can be added and removed at any time. An async context manager."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._outputs: list[Output] = []
        self._router = PacketRouter(node.dialect)
        #: The router's port for all links of the node.
        self._links = self._router.add_port()
        self._ports: dict[int, tuple[Output, Channel]] = {}
        self._listener = node.add_packet_listener(None, self._forward)

    @property
    def outputs(self) -> Sequence[Output]:
        """The open outputs, in the order in which they were added."""
        return tuple(self._outputs)

    async def add(self, link: str | Link) -> Output:
        """Forward packets to a link from now on.

        Args:
            link: A URL, or a link from `mavstack.links`.

        Returns:
            The output.

        Raises:
            LinkError: The link cannot be opened, or is an output already.
            LinkURLError: The URL is invalid, or has options that would change packets.
        """
        output = Output(open_link(link) if isinstance(link, str) else link)
        if given := output.link.settings.given:
            raise LinkURLError(
                f"{output.link.url.redacted}: packets are forwarded unchanged, "
                f"so that the option {given[0]} has no effect; remove it"
            )
        if any(output.url == other.url for other in self._outputs):
            raise LinkError(f"{output.url} is an output already")
        await output.link.open()
        output.task = asyncio.get_running_loop().create_task(self._read(output))
        self._outputs.append(output)
        await asyncio.sleep(0)  # let the task report the channels that are open already
        return output

    async def remove(self, output: str | int) -> Output:
        """Stop forwarding to a link, and close it.

        Args:
            output: Its URL, or its index in `outputs`.

        Returns:
            The removed output.

        Raises:
            InvalidArgumentError: There is no such output.
        """
        removed = self._find(output)
        self._outputs.remove(removed)
        await self._stop(removed)
        return removed

    async def close(self) -> None:
        """Close all outputs. Idempotent."""
        self._listener.close()
        outputs, self._outputs = self._outputs, []
        for output in outputs:
            await self._stop(output)

    def _find(self, url_or_index: str | int) -> Output:
        if isinstance(url_or_index, int) and 0 <= url_or_index < len(self._outputs):
            return self._outputs[url_or_index]
        for output in self._outputs:
            if output.url == str(url_or_index):
                return output
        urls = ", ".join(output.url for output in self._outputs) or "none"
        raise InvalidArgumentError(f"{url_or_index} is not an output; outputs: {urls}")

    async def _stop(self, output: Output) -> None:
        if output.task is not None:
            output.task.cancel()
            await asyncio.gather(output.task, return_exceptions=True)
        await output.link.close()
        for channel in tuple(output.channels):
            self._close_channel(output, channel)

    def _forward(self, packet: Packet) -> None:
        """Forward a packet that the node received."""
        self._route(packet, self._links)

    def _route(self, packet: Packet, source: int) -> None:
        for port in self._router.route(source, packet.raw, monotonic()):
            if port == self._links:
                if self._node.is_open:
                    self._node.forward(packet)
                continue
            output, channel = self._ports[port]
            try:
                output.sent += channel.write(packet.raw)
            except LinkClosedError:
                continue  # the link reports the loss with ChannelClosed

    async def _read(self, output: Output) -> None:
        async for event in output.link:
            self._handle(output, event)

    def _handle(self, output: Output, event: LinkEvent) -> None:
        match event:
            case ChannelOpened(channel):
                port = self._router.add_port()
                output.channels[channel] = OutputChannel(port, Parser(self._node.dialect))
                self._ports[port] = output, channel
            case ChannelClosed(channel):
                self._close_channel(output, channel)
            case BytesReceived(channel, data):
                opened = output.channels[channel]
                for packet in opened.parser.feed(data):
                    output.received += 1
                    self._route(packet, opened.port)

    def _close_channel(self, output: Output, channel: Channel) -> None:
        if closed := output.channels.pop(channel, None):
            self._router.remove_port(closed.port)
            del self._ports[closed.port]

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()
