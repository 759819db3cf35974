"""Base maps of the station in Chromium: tiles and an archive of another server."""

from __future__ import annotations

import struct
import threading
import zlib
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING, Any, ClassVar

import pytest

from tests.interop.station import DESKTOP, PATIENT, near, station_page, web_server

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from tests.interop.station import StationPage

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

#: The colours of the tiles and of the archive, and pixels of the map that must have them.
TILES, ARCHIVE, ENOUGH = (200, 40, 40), (40, 160, 60), 100_000
_SIZE = 256
_UNCOMPRESSED, _PNG = 1, 2
_HEADER = struct.Struct("<7sB8Q3Q6B4iB2i")


def picture(colour: tuple[int, int, int]) -> bytes:
    """Return a tile of one colour (PNG)."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">2I5B", _SIZE, _SIZE, 8, 2, 0, 0, 0)
    rows = (b"\0" + bytes(colour) * _SIZE) * _SIZE
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows))
        + chunk(b"IEND", b"")
    )


def archive(tile: bytes) -> bytes:
    """Return a PMTiles archive (version 3) with one tile for the whole Earth."""
    length, size = b"", len(tile)
    while size > 0x7F:
        length, size = length + bytes([size & 0x7F | 0x80]), size >> 7
    directory = b"\x01\x00\x01" + length + bytes([size]) + b"\x01"
    metadata, start = b"{}", _HEADER.size
    places = (start, len(directory), start + len(directory), len(metadata), 0, 0)
    first = start + len(directory) + len(metadata)
    kinds = (1, _UNCOMPRESSED, _UNCOMPRESSED, _PNG, 0, 0)
    bounds = (-1_800_000_000, -850_000_000, 1_800_000_000, 850_000_000)
    header = _HEADER.pack(b"PMTiles", 3, *places, first, len(tile), 1, 1, 1, *kinds, *bounds, 0, 0, 0)
    return header + directory + metadata + tile


class TileHandler(BaseHTTPRequestHandler):
    """Answers with tiles and parts of the archive, below /closed without leave for other pages."""

    files: ClassVar[dict[str, bytes]] = {".png": picture(TILES), ".pmtiles": archive(picture(ARCHIVE))}

    def do_OPTIONS(self) -> None:
        self._answer(204, b"")

    def do_GET(self) -> None:
        data = next((data for end, data in self.files.items() if self.path.endswith(end)), None)
        wanted = self.headers["Range"]
        if data is None:
            self._answer(404, b"")
        elif wanted is None:
            self._answer(200, data)
        else:
            start, end = map(int, wanted.removeprefix("bytes=").split("-"))
            part = data[start : end + 1]
            self._answer(206, part, f"bytes {start}-{start + len(part) - 1}/{len(data)}")

    def _answer(self, status: int, data: bytes, content_range: str | None = None) -> None:
        self.send_response(status)
        if not self.path.startswith("/closed"):
            self.send_header("Access-Control-Allow-Origin", "*")
            self.send_header("Access-Control-Allow-Headers", "Range")
        if content_range is not None:
            self.send_header("Content-Range", content_range)
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def log_message(self, *_: object) -> None:
        """Say nothing."""


@contextmanager
def tile_server() -> Iterator[str]:
    """Serve tiles and an archive; yields the address."""
    with ThreadingHTTPServer(("127.0.0.1", 0), TileHandler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()
        thread.join()


def choose_tiles(shown: StationPage, address: str) -> None:
    """Enter the address of tiles in the settings."""
    shown.page.keyboard.press(",")
    shown.page.get_by_label("Map tiles").fill(address)
    shown.page.keyboard.press("Tab")
    shown.page.keyboard.press("Escape")
    shown.page.get_by_label("Map tiles").wait_for(state="hidden", timeout=PATIENT)


def test_tiles_and_an_archive_are_the_base_map(browser: Any, tmp_path: Path) -> None:
    with (
        tile_server() as tiles,
        web_server(tmp_path) as server,
        station_page(browser, server.url, DESKTOP, "light") as shown,
    ):
        shown.page.goto(f"{server.url}?demo=1")
        shown.button("Choose a vehicle: Copter 1").wait_for(timeout=PATIENT)
        area = shown.page.locator(".map")
        for path, colour in (("{z}/{x}/{y}.png", TILES), ("earth.pmtiles", ARCHIVE)):
            choose_tiles(shown, f"{tiles}/{path}")
            shown.wait_until(lambda colour=colour: near(shown.pixels(area), colour) > ENOUGH)
        problem = shown.page.get_by_text("The map tiles cannot be read")
        assert problem.count() == 0
        choose_tiles(shown, f"{tiles}/closed/{{z}}/{{x}}/{{y}}.png")
        problem.wait_for(timeout=PATIENT)
        expected = (tiles, "Access to", "Failed to load resource")
        shown.problems[:] = [each for each in shown.problems if not each.startswith(expected)]
