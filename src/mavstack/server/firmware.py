"""Flashing for clients of the station: one at a time at each port, whose source is closed meanwhile."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import MavstackError
from mavstack.flashing import flash_firmware
from mavstack.flashing.board_flasher import BoardFlasher
from mavstack.flashing.bootloader_port import port_url
from mavstack.flashing.options import FlashOptions
from mavstack.http.bodies import RefusedError
from mavstack.links import parse_url
from mavstack.links.client_urls import is_network_or_device_scheme
from mavstack.server.source_options import refuse_paths

if TYPE_CHECKING:
    from mavstack.flashing import Board, FirmwareFile, FlashResult
    from mavstack.server.sources import Source, Sources


class StationFlasher:
    """The flashing of one station.

    Args:
        sources: The sources of the station.
    """

    def __init__(self, sources: Sources) -> None:
        self._sources = sources
        self._busy: set[str] = set()

    async def flash(self, firmware: FirmwareFile, port: str, options: FlashOptions) -> FlashResult:
        """Flash the device at a port; a source that has the port open is closed before and opened after.

        Raises:
            RefusedError: The port is being flashed already, or is neither a serial port nor a network link.
            FlashingError: Flashing failed, or was refused.
            LinkError: The port cannot be opened.
        """
        url = self._claim(port)
        try:
            closed = await self._close_sources(url)
            try:
                return await flash_firmware(firmware, port, options)
            finally:
                await self._open_sources(closed)
        finally:
            self._busy.discard(url)

    async def identify(self, port: str) -> Board | None:
        """Return the board in its bootloader at a port that no source has open; None if none answers."""
        url = self._claim(port)
        try:
            return await BoardFlasher(port, FlashOptions()).identify()
        finally:
            self._busy.discard(url)

    def _claim(self, port: str) -> str:
        """Mark a port as being flashed; return its place, which has no options."""
        url = parse_url(port_url(port))
        if not is_network_or_device_scheme(url.scheme):
            text = f"only serial ports and links of the network can be flashed, not {url.scheme}:"
            raise RefusedError(403, text)
        refuse_paths(url)
        place = _place_of(port_url(port))
        if place in self._busy:
            raise RefusedError(409, f"{port} is being flashed already")
        self._busy.add(place)
        return place

    async def _close_sources(self, place: str) -> list[str]:
        """Close the sources at a place; return their URLs."""
        found = [each for each in self._sources.list() if _place_of(str(each.link.url)) == place]
        urls = [_url_of(each) for each in found]
        for source in found:
            await self._sources.remove(source.id)
        return urls

    async def _open_sources(self, urls: list[str]) -> None:
        """Open sources again; a device that is gone is left out, and the client adds it when it is back."""
        for url in urls:
            try:
                await self._sources.add(url)
            except MavstackError:
                continue


def _place_of(url: str) -> str:
    parsed = parse_url(url)
    carrier = parsed.scheme.rpartition("+")[2]
    return f"{carrier}:{parsed.host or ''}:{parsed.port or ''}{parsed.path}"


def _url_of(source: Source) -> str:
    return str(source.link.url)
