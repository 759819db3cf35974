"""Forwarding: other programs share the links of a node.

    async with Forwarding(node) as forwarding:
        await forwarding.add("udpout://127.0.0.1:14551")

Every packet that the node receives is sent unchanged to every output; every packet received from an output is
sent unchanged to its target. Bytes are split into packets, so that streams and datagrams can be on either
side and packets never interleave; bytes that are not MAVLink are dropped. Packets from one output reach
neither the other outputs nor the program's own subscriptions. SETUP_SIGNING is never forwarded, in neither
direction, because it carries a signing key in the clear.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError, LinkClosedError, LinkError, LinkURLError
from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened, Link, open_link
from mavstack.security import carries_signing_key
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
    """A link that packets are forwarded to, with its counters in packets."""

    link: Link
    sent: int = 0
    received: int = 0
    parsers: dict[Channel, Parser] = field(default_factory=dict)
    task: asyncio.Task[None] | None = None

    @property
    def url(self) -> str:
        """The URL of the link."""
        return str(self.link.url)

    @property
    def peers(self) -> int:
        """The number of open channels of the link."""
        return len(self.parsers)


class Forwarding:
    """The outputs of a node; they can be added and removed at any time. An async context manager."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._outputs: list[Output] = []
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
        await asyncio.sleep(0)  # channels that are open already are reported
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

    def _forward(self, packet: Packet) -> None:
        if carries_signing_key(packet):
            return
        for output in self._outputs:
            for channel in tuple(output.parsers):
                try:
                    output.sent += channel.write(packet.raw)
                except LinkClosedError:
                    continue  # its ChannelClosed follows

    async def _read(self, output: Output) -> None:
        async for event in output.link:
            self._handle(output, event)

    def _handle(self, output: Output, event: LinkEvent) -> None:
        match event:
            case ChannelOpened(channel):
                output.parsers[channel] = Parser(self._node.dialect)
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
