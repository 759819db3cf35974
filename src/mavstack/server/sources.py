"""The sources of a station: links that are opened and closed while it runs."""

from __future__ import annotations

from dataclasses import asdict, replace
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mavstack.http.bodies import RefusedError
from mavstack.links.client_urls import is_network_or_device_scheme
from mavstack.links.registry import resolve_url
from mavstack.server.rows.decoder_file import read_decoder_file
from mavstack.server.rows.hub import RowHub
from mavstack.server.rows.source import RowReader
from mavstack.server.rows.urls import is_row_url, parse_row_url
from mavstack.server.source_options import refuse_paths, same_error_for_keys

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.links import Link
    from mavstack.vehicle import Connection

MAX_SOURCES: Final = 256


class Source:
    """A link of the station."""

    def __init__(self, number: str, link: Link) -> None:
        self.id = number
        self.link = link

    @property
    def state(self) -> str:
        """`closed`, `waiting` for a peer, `connected`, or `ended`: a log that was replayed to its end."""
        if self.link.closed:
            return "closed"
        if self.link.channels:
            return "connected"
        return "ended" if self.link.url.scheme == "file" else "waiting"

    def values(self) -> dict[str, Any]:
        """Return the source as JSON."""
        return {
            "id": self.id,
            "url": self.link.url.redacted,
            "state": self.state,
            "address": None if self.link.address is None else list(self.link.address),
            "channels": [channel.name for channel in self.link.channels],
            "counters": asdict(self.link.counters),
        }


class RowSource(Source):
    """A link whose lines are rows of values; its JSON also has `rows`."""

    def __init__(self, number: str, reader: RowReader) -> None:
        super().__init__(number, reader.link)
        self.reader = reader

    def values(self) -> dict[str, Any]:
        """Return the source as JSON."""
        return {**super().values(), "url": self.reader.url.text, "rows": self.reader.values()}


class Sources:
    """The sources of one connection.

    Args:
        connection: The connection, open or not.
        network_only: Open only links of networks and serial ports for clients; see `links.client_urls`.
    """

    def __init__(self, connection: Connection, *, network_only: bool = False) -> None:
        #: The rows of all sources that are not MAVLink links.
        self.rows = RowHub()
        self._connection = connection
        self._network_only = network_only
        self._numbers = count(1)
        self._sources: dict[str, Source] = {}
        for link in connection.links:
            self._register(link)

    def list(self) -> list[Source]:
        """Return the sources, oldest first."""
        return list(self._sources.values())

    def find(self, number: str) -> Source:
        """Return a source by its id; raises `RefusedError` if there is none."""
        source = self._sources.get(number)
        if source is None:
            raise RefusedError(404, f"there is no source {number[:20]}")
        return source

    async def add(
        self, link: str | Link, *, decoder: Mapping[str, Any] | None = None, from_client: bool = False
    ) -> Source:
        """Open a link.

        Args:
            link: A URL, a serial port such as `/dev/ttyACM0,57600`, a URL of rows, or a link.
            decoder: The declaration of the decoder of a URL of frames; None: the URL names a file, or none.
            from_client: A client of the API asks for it, so that the limits for clients hold.

        Returns:
            The source.

        Raises:
            RefusedError: Clients may not open that link, or there are too many.
            InvalidArgumentError: The URL contradicts the address of the station, or has a bad template or
                decoder.
            LinkError: The link cannot be opened.
        """
        if len(self._sources) >= MAX_SOURCES:
            raise RefusedError(409, f"there are {MAX_SOURCES} sources already: remove one")
        if isinstance(link, str) and is_row_url(link):
            return await self._add_rows(link, decoder, limited=from_client and self._network_only)
        if decoder is not None:
            raise RefusedError(400, "only a source of frames (frames+udp://… and others) takes a decoder")
        if isinstance(link, str):
            url = resolve_url(link)
            if from_client and self._network_only and not is_network_or_device_scheme(url.scheme):
                allowed = "links of the network and serial ports"
                raise RefusedError(403, f"without a password only {allowed} can be opened, not {url.scheme}:")
            if from_client and self._network_only:
                refuse_paths(url)
                with same_error_for_keys(url):
                    return self._register(await self._connection.add_link(str(url)))
            link = str(url)
        return self._register(await self._connection.add_link(link))

    async def remove(self, number: str) -> Source:
        """Close a source, and drop it."""
        source = self.find(number)
        del self._sources[number]
        if isinstance(source, RowSource):
            await source.reader.close()
        else:
            await self._connection.remove_link(source.link)
        return source

    async def close_rows(self) -> None:
        """Close the sources of rows; the connection closes the others."""
        for source in self.list():
            if isinstance(source, RowSource):
                await self.remove(source.id)

    async def _add_rows(self, text: str, decoder: Mapping[str, Any] | None, *, limited: bool) -> Source:
        url = parse_row_url(text, decoder)
        if limited:
            refuse_paths(url.link)
            if url.decoder_file:
                raise RefusedError(403, "without a password no file can be named: send the decoder itself")
        if url.decoder_file:
            url = replace(url, decoder=read_decoder_file(Path(url.decoder_file)))
        number = str(next(self._numbers))
        name = url.name or f"rows{number}"
        names = [each.reader.name for each in self.list() if isinstance(each, RowSource)]
        if name in names:
            raise RefusedError(409, f"there is a source of rows named {name} already")
        source = RowSource(number, RowReader(url, name, self.rows))
        self._sources[number] = source  # register it before it opens, so that its name is reserved
        try:
            await source.reader.open()
        except BaseException:
            self._sources.pop(number, None)
            raise
        return source

    def _register(self, link: Link) -> Source:
        source = Source(str(next(self._numbers)), link)
        self._sources[source.id] = source
        return source
