"""A source of rows: a link whose lines are read by templates."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

from mavstack.links import BytesReceived, ChannelClosed, open_link
from mavstack.server.rows.lines import LineAssembler
from mavstack.server.rows.template import parse_row

if TYPE_CHECKING:
    from mavstack.links import Link
    from mavstack.links.channel import Channel
    from mavstack.server.rows.hub import RowHub
    from mavstack.server.rows.urls import RowUrl


class RowReader:
    """Reads the rows of a link and hands them to a hub.

    Args:
        url: The URL of the source.
        name: The name of the source.
        hub: The hub that takes the rows.
        link: The link that carries the lines, not open; None: that of the URL.
    """

    def __init__(self, url: RowUrl, name: str, hub: RowHub, *, link: Link | None = None) -> None:
        self.url = url
        self.name = name
        self.link = open_link(url.link) if link is None else link
        #: Lines that became rows.
        self.received = 0
        #: Lines that fit no template, and lines that were too long.
        self.refused = 0
        self._hub = hub
        self._lines: dict[Channel, LineAssembler] = {}
        self._task: asyncio.Task[None] | None = None

    async def open(self) -> None:
        """Open the link and read; raises `LinkError` if it cannot be opened."""
        await self.link.open()
        self._task = asyncio.get_running_loop().create_task(self._read())

    async def close(self) -> None:
        """Close the link. Idempotent."""
        await self.link.close()
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
        self._hub.forget(self.name)

    def values(self) -> dict[str, Any]:
        """Return what the source adds to its JSON: name, columns by message, and counters of lines."""
        messages = {
            template.message: [
                {"name": column.name, "unit": column.unit}
                for column in template.columns
                if column is not None
            ]
            for template in self.url.templates
        }
        return {
            "name": self.name,
            "messages": messages,
            "received": self.received,
            "refused": self.refused,
        }

    async def _read(self) -> None:
        async for event in self.link:
            match event:
                case BytesReceived(channel, data, time):
                    self._take(self._lines.setdefault(channel, LineAssembler()), data, time)
                case ChannelClosed(channel):
                    self._lines.pop(channel, None)

    def _take(self, lines: LineAssembler, data: bytes, time: float) -> None:
        before = lines.dropped
        for line in lines.feed(data):
            row = parse_row(self.url.templates, line)
            if row is None:
                self.refused += 1
            else:
                self.received += 1
                self._hub.publish(self.name, row, time)
        self.refused += lines.dropped - before
