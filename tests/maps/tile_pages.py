"""A web server of tiles for tests: each tile is a picture whose colour is its place."""

from __future__ import annotations

import struct
import threading
import zlib
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

Answer = tuple[int, bytes, dict[str, str]]


def png(pixels: list[list[tuple[int, int, int]]]) -> bytes:
    """Return a picture (PNG) of rows of colours."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + bytes(part for pixel in row for part in pixel) for row in pixels)
    header = struct.pack(">2I5B", len(pixels[0]), len(pixels), 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows))
        + chunk(b"IEND", b"")
    )


def picture(zoom: int, x: int, y: int) -> Answer:
    """Return the tile at a place."""
    return 200, png([[(zoom, x % 256, y % 256)] * 2] * 2), {"Content-Type": "image/png"}


@dataclass
class Pages:
    """The server: its address, and the paths that were requested."""

    url: str
    answer: Callable[[int, int, int], Answer] = picture
    requested: list[str] = field(default_factory=list)
    agents: set[str] = field(default_factory=set)

    @property
    def template(self) -> str:
        return self.url + "/{z}/{x}/{y}.png"


@contextmanager
def tile_pages(answer: Callable[[int, int, int], Answer] = picture) -> Iterator[Pages]:
    """Serve tiles."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            pages.requested.append(self.path)
            pages.agents.add(self.headers["User-Agent"])
            zoom, x, y = (int(part.partition(".")[0]) for part in self.path.strip("/").split("/")[-3:])
            status, data, headers = pages.answer(zoom, x, y)
            self.send_response(status)
            for name, value in headers.items():
                self.send_header(name, value)
            self.send_header("Content-Length", str(len(data)))
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, *_: object) -> None:
            """Say nothing."""

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        pages = Pages(f"http://127.0.0.1:{server.server_port}", answer)
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        try:
            yield pages
        finally:
            server.shutdown()
            thread.join()
