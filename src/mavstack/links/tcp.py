"""TCP links: `tcpin://host:port` accepts connections, each a channel; `tcpout://host:port` connects."""

from __future__ import annotations

import asyncio
import socket
import sys
from functools import partial
from typing import TYPE_CHECKING

from mavstack.links.address import format_address, resolve
from mavstack.links.certificates import client_subject
from mavstack.links.connection import ClientLink, ConnectionChannel, ServerLink
from mavstack.links.os_errors import open_error
from mavstack.links.role_gate import RoleGate
from mavstack.links.stream import (
    DirectProtocol,
    StreamChannel,
    connect_stream,
    enable_keepalive,
    keep_alive,
    stop_accepting,
)

if TYPE_CHECKING:
    import ssl

    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL


#: Maximum number of connections that wait to be accepted.
BACKLOG = 100


class TcpServer(ServerLink):
    """A link that listens; every connection is a channel."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._server: asyncio.Server | None = None
        self._roles = RoleGate(url, options)

    @property
    def address(self) -> tuple[str, int] | None:
        """Host and port on which the link listens, or None before it is open."""
        return self._server.sockets[0].getsockname()[:2] if self._server and self._server.sockets else None

    async def open_transport(self) -> None:
        """Open the transport of the link."""
        try:
            self._server = await asyncio.get_running_loop().create_server(
                self._new_protocol, self.url.host, self.url.port
            )
        except OSError as error:
            raise open_error(self.url, error) from error

    async def open_sockets(self) -> list[socket.socket]:
        """Open the listening sockets alone, one for each address, for a program that accepts itself.

        Raises:
            LinkError: An address cannot be listened on.
        """
        sockets: list[socket.socket] = []
        try:
            for family, address in await resolve(self.url.host, self.url.port, socket.SOCK_STREAM):
                sockets.append(sock := socket.socket(family, socket.SOCK_STREAM))
                sock.setblocking(False)
                if sys.platform != "win32":
                    sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                if family == socket.AF_INET6:
                    sock.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
                sock.bind(address)
                sock.listen(BACKLOG)
        except OSError as error:
            for sock in sockets:
                sock.close()
            raise open_error(self.url, error) from error
        return sockets

    def _new_protocol(self) -> asyncio.Protocol:
        """Return the protocol of a connection that is being accepted."""
        return DirectProtocol(asyncio.StreamReader(), self._accept)

    def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        enable_keepalive(writer)
        peer = format_address(writer.get_extra_info("peername"))
        name = f"{self.url.scheme} {peer}"
        connection = StreamChannel(name, peer, self.inbox.remove_channel, (reader, writer), self._send_queue)
        connection.identity = client_subject(writer.transport)
        connection.role_filter = self._roles.filter_of(connection.identity)
        if self._admit(connection):
            self.spawn(self._serve_task(connection))

    async def stop_transport(self) -> None:
        """Stop accepting peers and bytes."""
        if self._server is not None:
            await stop_accepting(self._server.sockets)
            self._server.close()

    async def release_transport(self) -> None:
        """Release the remaining resources."""
        if self._server is not None:
            await self._server.wait_closed()


class TcpClient(ClientLink):
    """A link that connects to a server; the option `timeout` limits each attempt in seconds."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self.timeout = options.seconds("timeout", 5.0)
        self._ssl: ssl.SSLContext | None = None
        self._server_name = url.host

    async def _connect(self) -> ConnectionChannel:
        async with asyncio.timeout(self.timeout):
            reader, writer = await self._connect_any()
        enable_keepalive(writer)
        peer = format_address(writer.get_extra_info("peername"))
        name = f"{self.url.scheme} {peer}"
        return StreamChannel(name, peer, self.inbox.remove_channel, (reader, writer), self._send_queue)

    async def connect_socket(self) -> socket.socket:
        """Connect a socket alone, for a program that reads it itself; raises `OSError`."""
        failure: OSError | None = None
        for family, address in await resolve(self.url.host, self.url.port, socket.SOCK_STREAM):
            sock = socket.socket(family, socket.SOCK_STREAM)
            sock.setblocking(False)
            try:
                async with asyncio.timeout(self.timeout):
                    await asyncio.get_running_loop().sock_connect(sock, address)
            except OSError as error:  # also a timeout
                sock.close()
                failure = error
            except BaseException:
                sock.close()
                raise
            else:
                keep_alive(sock)
                return sock
        raise failure or OSError("the host has no address")

    async def _connect_any(self) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        """Try all addresses of the host in turn; if all fail, raise the last error."""
        failure: OSError | None = None
        loop, name = asyncio.get_running_loop(), self._server_name if self._ssl else None
        for _, address in await resolve(self.url.host, self.url.port, socket.SOCK_STREAM):
            connect = partial(
                loop.create_connection,
                host=address[0],
                port=address[1],
                ssl=self._ssl,
                server_hostname=name,
            )
            try:
                return await connect_stream(connect)
            except OSError as error:
                failure = error
        raise failure or OSError("the host has no address")
