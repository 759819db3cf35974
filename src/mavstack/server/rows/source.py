"""A source of rows: a link whose lines are read by templates, or whose frames are read by a decoder."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

from mavstack.links import BytesReceived, ChannelClosed, open_link
from mavstack.links.options import Options
from mavstack.server.rows.frame_decoder import FrameReader
from mavstack.server.rows.lines import LineReader
from mavstack.server.rows.mqtt import SCHEMES as MQTT
from mavstack.server.rows.mqtt import MqttLink

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
        link: The link that carries the lines or frames, not open; None: that of the URL.
    """

    def __init__(self, url: RowUrl, name: str, hub: RowHub, *, link: Link | None = None) -> None:
        self.url = url
        self.name = name
        self.link = _open(url) if link is None else link
        #: Number of lines and frames that were read as rows.
        self.received = 0
        #: Number of lines and frames that match no template, are too long, or are damaged.
        self.refused = 0
        self._hub = hub
        self._readers: dict[Channel, LineReader | FrameReader] = {}
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
        """Return what the source adds to its JSON: name, columns by message, and counters."""
        messages = {
            template.message: [
                {"name": column.name, "unit": column.unit}
                for column in template.columns
                if column is not None
            ]
            for template in self.url.templates
        }
        for message in self.url.decoder.messages if self.url.decoder else ():
            messages[message.name] = [{"name": each.name, "unit": each.unit} for each in message.fields]
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
                    self._take(self._reader(channel), data, time)
                case ChannelClosed(channel):
                    self._readers.pop(channel, None)

    def _reader(self, channel: Channel) -> LineReader | FrameReader:
        reader = self._readers.get(channel)
        if reader is None:
            templates = self.url.templates
            reader = LineReader(templates) if templates else FrameReader(self.url.decoder)
            self._readers[channel] = reader
        return reader

    def _take(self, reader: LineReader | FrameReader, data: bytes, time: float) -> None:
        if self.url.templates and self.url.link.scheme in MQTT:
            data += b"\n"  # each MQTT message is one line
        before = reader.refused
        for row in reader.feed(data):
            self.received += 1
            self._hub.publish(self.name, row, time)
        self.refused += reader.refused - before


def _open(url: RowUrl) -> Link:
    if url.link.scheme not in MQTT:
        return open_link(url.link)
    options = Options(url.link)
    link = MqttLink(url.link, options)
    options.refuse_unknown()
    return link
