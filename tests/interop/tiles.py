"""A web server of map tiles: pictures of one colour, an area of vectors, archives of one tile."""

from __future__ import annotations

import json
import struct
import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from io import BytesIO
from typing import TYPE_CHECKING, ClassVar

import matplotlib.image
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

#: Kinds of tiles of an archive.
VECTORS, PNG = 1, 2
_SIZE = 256
_UNCOMPRESSED = 1
_HEADER = struct.Struct("<7sB8Q3Q6B4iB2i")
#: Geometry of a polygon that covers a tile of 4096 units: move, three lines, end. Steps are zigzag numbers.
_WHOLE_TILE = (9, 0, 0, 26, 8192, 0, 0, 8192, 8191, 0, 15)


def picture(colour: tuple[int, int, int]) -> bytes:
    """Return a tile of one colour (PNG)."""
    data = BytesIO()
    matplotlib.image.imsave(data, np.full((_SIZE, _SIZE, 3), colour, np.uint8), format="png")
    return data.getvalue()


def varint(value: int) -> bytes:
    """Return a number as protocol buffers and PMTiles write it."""
    return bytes([value & 0x7F | 0x80]) + varint(value >> 7) if value > 0x7F else bytes([value])


def area(layer: str) -> bytes:
    """Return a tile of vectors (MVT) whose layer covers it."""

    def data(member: int, content: bytes) -> bytes:
        return varint(member << 3 | 2) + varint(len(content)) + content

    def number(member: int, value: int) -> bytes:
        return varint(member << 3) + varint(value)

    polygon = number(3, 3) + data(4, b"".join(map(varint, _WHOLE_TILE)))
    return data(3, data(1, layer.encode()) + data(2, polygon) + number(5, 4096) + number(15, 2))


def archive(tile: bytes, kind: int = PNG, layers: tuple[str, ...] = ()) -> bytes:
    """Return a PMTiles archive (version 3) with one tile for the whole Earth."""
    directory = b"\x01\x00\x01" + varint(len(tile)) + b"\x01"
    metadata = json.dumps({"vector_layers": [{"id": layer, "fields": {}} for layer in layers]}).encode()
    start = _HEADER.size
    places = (start, len(directory), start + len(directory), len(metadata), 0, 0)
    first = start + len(directory) + len(metadata)
    kinds = (1, _UNCOMPRESSED, _UNCOMPRESSED, kind, 0, 0)
    bounds = (-1_800_000_000, -850_000_000, 1_800_000_000, 850_000_000)
    header = _HEADER.pack(b"PMTiles", 3, *places, first, len(tile), 1, 1, 1, *kinds, *bounds, 0, 0, 0)
    return header + directory + metadata + tile


class TileHandler(BaseHTTPRequestHandler):
    """Answers with tiles and parts of the archive, below /closed without leave for other pages."""

    #: The answers by the end of the path.
    files: ClassVar[Mapping[str, bytes]] = {}

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
def tile_server(files: Mapping[str, bytes]) -> Iterator[str]:
    """Serve files, each for all paths that end so; yields the address."""
    handler = type("Handler", (TileHandler,), {"files": files})
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            thread.join()
