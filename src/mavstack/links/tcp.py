"""TCP links: `tcpin://host:port` accepts connections, each a channel; `tcpout://host:port` connects."""

from __future__ import annotations

import asyncio
import socket
from typing import TYPE_CHECKING

from mavstack.links.address import format_address, resolve
from mavstack.links.connection import ClientLink, ConnectionChannel, ServerLink
from mavstack.links.os_errors import open_error
from mavstack.links.stream import StreamChannel, enable_keepalive, stop_accepting

if TYPE_CHECKING:
    import ssl

    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL


class TcpServer(ServerLink):
    """A link that listens; every connection is a channel."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._server: asyncio.Server | None = None

    @property
    def address(self) -> tuple[str, int] | None:
        """Host and port on which the link listens, or None before it is open."""
        return self._server.sockets[0].getsockname()[:2] if self._server and self._server.sockets else None

    async def _open(self) -> None:
        try:
            self._server = await asyncio.get_running_loop().create_server(
                self._new_protocol, self.url.host, self.url.port
            )
        except OSError as error:
            raise open_error(self.url, error) from error

    def _new_protocol(self) -> asyncio.Protocol:
        """Return the protocol of a connection that is being accepted."""
        return asyncio.StreamReaderProtocol(asyncio.StreamReader(), self._accept)

    def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        enable_keepalive(writer)
        peer = format_address(writer.get_extra_info("peername"))
        name = f"{self.url.scheme} {peer}"
        connection = StreamChannel(name, peer, self._inbox.remove_channel, (reader, writer), self._send_queue)
        if self._admit(connection):
            self._spawn(self._serve_task(connection))

    async def _stop(self) -> None:
        if self._server is not None:
            await stop_accepting(self._server.sockets)
            self._server.close()

    async def _release(self) -> None:
        if self._server is not None:
            await self._server.wait_closed()


class TcpClient(ClientLink):
    """A link that connects to a server; the option `timeout` limits each attempt in seconds."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._timeout = options.seconds("timeout", 5.0)
        self._ssl: ssl.SSLContext | None = None
        self._server_name = url.host

    async def _connect(self) -> ConnectionChannel:
        async with asyncio.timeout(self._timeout):
            reader, writer = await self._connect_any()
        enable_keepalive(writer)
        peer = format_address(writer.get_extra_info("peername"))
        name = f"{self.url.scheme} {peer}"
        return StreamChannel(name, peer, self._inbox.remove_channel, (reader, writer), self._send_queue)

    async def _connect_any(self) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        """Try all addresses of the host in turn; if all fail, raise the last error."""
        failure: OSError | None = None
        for _, address in await resolve(self.url.host, self.url.port, socket.SOCK_STREAM):
            try:
                return await asyncio.open_connection(
                    address[0],
                    address[1],
                    ssl=self._ssl,
                    server_hostname=self._server_name if self._ssl else None,
                )
            except OSError as error:
                failure = error
        raise failure or OSError("the host has no address")
