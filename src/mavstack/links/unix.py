"""Unix socket links: `unix://path` connects, `unixin://path` listens. Not available on Windows.

The bytes are a plain stream of packets, or frames with `framing=length` (see `framing`); both ends must
agree.
"""

from __future__ import annotations

import asyncio
import socket
import stat
import sys
from functools import partial
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.errors import LinkError
from mavstack.links.connection import ClientLink, ConnectionChannel, ServerLink
from mavstack.links.os_errors import open_error
from mavstack.links.stream import StreamChannel, connect_stream, stop_accepting

if TYPE_CHECKING:
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL


#: Maximum number of connections that wait to be accepted.
BACKLOG = 100


def _require_posix(url: LinkURL) -> None:
    if sys.platform == "win32":
        raise LinkError(
            f"cannot open {url.redacted}: unix sockets are not available on Windows; "
            "use tcpin:// and tcpout:// on 127.0.0.1"
        )


class UnixServer(ServerLink):
    """A link that listens on a path; every connection is a channel.

    Attributes:
        framed: The stream consists of frames with a length (`framing=length`).
    """

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._server: asyncio.Server | None = None
        self.framed = _is_framed(options)
        self._numbers = count(1)

    def open_socket(self) -> socket.socket:
        """Open the listening socket alone, for a program that accepts itself.

        Raises:
            LinkError: The path cannot be listened on.
        """
        _require_posix(self.url)
        path = Path(self.url.path)
        sock = socket.socket(socket.AF_UNIX)
        try:
            _remove_stale(path)
            sock.bind(str(path))
            sock.listen(BACKLOG)
        except OSError as error:
            sock.close()
            raise open_error(self.url, error) from error
        except LinkError:
            sock.close()
            raise
        sock.setblocking(False)
        return sock

    async def open_transport(self) -> None:
        """Open the transport of the link."""
        _require_posix(self.url)
        path = Path(self.url.path)
        try:
            _remove_stale(path)
            self._server = await asyncio.start_unix_server(self._accept, path)
        except OSError as error:
            raise open_error(self.url, error) from error

    def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        peer = f"{self.url.path}#{next(self._numbers)}"
        name = f"unixin {peer}"
        streams = reader, writer
        connection = StreamChannel(
            name, peer, self.inbox.remove_channel, streams, self._send_queue, framed=self.framed
        )
        if self._admit(connection):
            self.spawn(self._serve_task(connection))

    async def stop_transport(self) -> None:
        """Stop accepting peers and bytes."""
        if self._server is not None:
            await stop_accepting(self._server.sockets)
            self._server.close()
            self.remove_path()

    def remove_path(self) -> None:
        """Remove the socket from the file system. Idempotent."""
        Path(self.url.path).unlink(missing_ok=True)

    async def release_transport(self) -> None:
        """Release the remaining resources."""
        if self._server is not None:
            await self._server.wait_closed()


class UnixClient(ClientLink):
    """A link that connects to a listening path.

    Attributes:
        framed: The stream consists of frames with a length (`framing=length`).
    """

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self.framed = _is_framed(options)

    async def connect_socket(self) -> socket.socket:
        """Connect a socket alone, for a program that reads it itself; raises `OSError` or `LinkError`."""
        _require_posix(self.url)
        sock = socket.socket(socket.AF_UNIX)
        sock.setblocking(False)
        try:
            await asyncio.get_running_loop().sock_connect(sock, self.url.path)
        except BaseException:
            sock.close()
            raise
        return sock

    async def _connect(self) -> ConnectionChannel:
        _require_posix(self.url)
        loop = asyncio.get_running_loop()
        streams = await connect_stream(partial(loop.create_unix_connection, path=self.url.path))
        name, path = f"unix {self.url.path}", self.url.path
        return StreamChannel(
            name, path, self.inbox.remove_channel, streams, self._send_queue, framed=self.framed
        )


def _is_framed(options: Options) -> bool:
    return options.choice("framing", ("none", "length")) == "length"


def _remove_stale(path: Path) -> None:
    """Remove the socket of a dead server; raise if the server is alive, because asyncio would replace it."""
    if not path.exists() or not stat.S_ISSOCK(path.stat().st_mode):
        return
    with socket.socket(socket.AF_UNIX) as probe:
        try:
            probe.connect(str(path))
        except ConnectionRefusedError:
            path.unlink()
        else:
            raise LinkError(f"cannot open unixin://{path}: another program listens on it: close that program")
