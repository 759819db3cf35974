"""The WebSockets of a relay: each is admitted by its ticket, read at its pace, and sent what waits for it."""

from __future__ import annotations

import asyncio
import logging
import ssl
from contextlib import asynccontextmanager, suppress
from http import HTTPStatus
from time import monotonic, time
from typing import TYPE_CHECKING, Any, Final, cast

from mavstack.errors import LinkError, MissingExtraError
from mavstack.handshakes import HANDSHAKE_TIMEOUT, Handshakes, TlsHandshake
from mavstack.links.relay_frames import MAX_MESSAGE, RELAY_PROTOCOL, offered_room_ticket
from mavstack.relay.revocations import READ_INTERVAL, Revocations
from mavstack.relay.rooms import Rooms
from mavstack.security.room_tickets import RoomTicket, RoomTickets
from mavstack.security.tickets import TicketRefusal

try:
    from websockets.asyncio.server import ServerConnection, serve
    from websockets.exceptions import WebSocketException
except ImportError as missing:
    raise MissingExtraError("a relay", "web") from missing

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from pathlib import Path

    from websockets.http11 import Request, Response
    from websockets.typing import Subprotocol

    from mavstack.relay.rooms import Limits, Member

#: Seconds between two pings.
PING_INTERVAL: Final = 15.0
#: Seconds to wait for the answer to a ping; then the connection ends, because its peer has gone.
PING_TIMEOUT: Final = 10.0
#: The close code for a member that has to leave, or for which there is no room ("try again later").
TRY_LATER: Final = 1013
#: The number of messages of a connection that the library buffers before it stops reading.
_MAX_BACKLOG: Final = 16

_logger = logging.getLogger("mavstack.relay")


class _Connection(ServerConnection):
    """A connection that is counted until its handshakes are done."""

    handshakes: Handshakes
    ticket: RoomTicket
    ticket_text: str

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        super().connection_made(transport)
        self.handshakes.begin(self.transport)

    def connection_lost(self, exc: Exception | None) -> None:
        self.handshakes.end(self.transport)
        super().connection_lost(exc)


class RelayServer:
    """The sockets of one relay.

    Args:
        api_key: The key of the tickets.
        limits: The bounds; None: the defaults.
        certificate: File with the certificate and its chain (PEM); None: without TLS, behind a proxy.
        certificate_key: File with the private key; None: it is in the file of the certificate.
        revoked: File with the revoked tickets, read again when it changes; None: no ticket is revoked.

    Attributes:
        rooms: The rooms.

    Raises:
        LinkError: The certificate cannot be used, or the file of revoked tickets cannot be read.
    """

    def __init__(
        self,
        api_key: str,
        limits: Limits | None = None,
        *,
        certificate: str | None = None,
        certificate_key: str | None = None,
        revoked: Path | None = None,
    ) -> None:
        self.rooms = Rooms(limits)
        self._tickets = RoomTickets(api_key)
        self._revocations = Revocations(revoked)
        self._members: dict[Member, str] = {}
        self._handshakes = Handshakes()
        self._context = _tls_context(certificate, certificate_key) if certificate else None

    @asynccontextmanager
    async def serving(self, host: str, port: int) -> AsyncIterator[int]:
        """Serve until the block ends.

        Args:
            host: The address to listen on.
            port: The port; 0: the system chooses one.

        Yields:
            The port.

        Raises:
            LinkError: The port cannot be opened.
        """
        try:
            server = await serve(
                self._serve, host, port,
                create_connection=self._new_connection,  # type: ignore[arg-type]
                process_request=self._check, subprotocols=[cast("Subprotocol", RELAY_PROTOCOL)],
                compression=None, max_size=MAX_MESSAGE, max_queue=_MAX_BACKLOG,
                open_timeout=HANDSHAKE_TIMEOUT, close_timeout=1,
                ping_interval=PING_INTERVAL, ping_timeout=PING_TIMEOUT, server_header=None,
            )  # fmt: skip
        except OSError as error:
            raise LinkError(f"listening on {host}:{port} failed: {error.strerror or error}") from error
        reader = asyncio.create_task(self._read_revocations())
        try:
            yield next(iter(server.sockets)).getsockname()[1]
        finally:
            reader.cancel()
            await asyncio.gather(reader, return_exceptions=True)
            self._handshakes.close()
            server.close()
            await server.wait_closed()

    def _new_connection(self, *arguments: Any, **settings: Any) -> Any:  # noqa: ANN401 (of websockets)
        connection = _Connection(*arguments, **settings)
        connection.handshakes = self._handshakes
        if self._context is None:
            return connection
        return TlsHandshake(connection, self._context, self._handshakes)

    def _check(self, socket: ServerConnection, request: Request) -> Response | None:
        """Return the response that refuses a client; None to accept it."""
        offered = offered_room_ticket(",".join(request.headers.get_all("Sec-WebSocket-Protocol")))
        found = self._tickets.verify(offered, time()) if offered else TicketRefusal.MISSING
        if isinstance(found, RoomTicket) and self._revocations.has(offered):
            found = TicketRefusal.REVOKED
        if isinstance(found, RoomTicket):
            connection = cast("_Connection", socket)
            connection.ticket, connection.ticket_text = found, offered
            return None
        self.rooms.counts[f"refused: {found}"] += 1
        return socket.respond(HTTPStatus.UNAUTHORIZED, f"{found}\n")

    async def _serve(self, socket: ServerConnection) -> None:
        connection = cast("_Connection", socket)
        self._handshakes.end(connection.transport)
        ticket, has_work = connection.ticket, asyncio.Event()
        address = str((socket.remote_address or ("",))[0])
        member = self.rooms.join(ticket.room, ticket.seat, address, has_work.set, monotonic())
        if isinstance(member, str):
            await socket.close(TRY_LATER, member)
            return
        _logger.info("room %s: %s came from %s", ticket.room, ticket.seat, address)
        self._members[member] = connection.ticket_text
        if self._revocations.has(connection.ticket_text):  # revoked since the check of the handshake
            self.rooms.dismiss(member, TicketRefusal.REVOKED)
        sender = asyncio.create_task(_send_all(socket, member, has_work))
        try:
            async with asyncio.timeout(max(0.0, ticket.expires - time())):
                await self._receive_all(socket, member)
        except TimeoutError:
            self.rooms.leave(member)
            await socket.close(TRY_LATER, TicketRefusal.EXPIRED)
        finally:
            del self._members[member]
            self.rooms.leave(member)
            sender.cancel()
            await asyncio.gather(sender, return_exceptions=True)
            _logger.info("room %s: %s from %s left", ticket.room, ticket.seat, address)

    async def _read_revocations(self) -> None:
        """Follow the file of revoked tickets, and end the connections that came with them."""
        while True:
            await asyncio.sleep(READ_INTERVAL)
            try:
                if not self._revocations.read():
                    continue
            except LinkError as error:
                _logger.warning("%s; the tickets revoked before stay revoked", error)
                continue
            for member, text in tuple(self._members.items()):
                if self._revocations.has(text):
                    self.rooms.dismiss(member, TicketRefusal.REVOKED)

    async def _receive_all(self, socket: ServerConnection, member: Member) -> None:
        with suppress(WebSocketException):
            async for message in socket:
                if isinstance(message, str):
                    self.rooms.counts["dropped"] += 1
                    continue
                pause = self.rooms.receive(member, message, monotonic())
                if pause > 0:
                    await asyncio.sleep(pause)


async def _send_all(socket: ServerConnection, member: Member, has_work: asyncio.Event) -> None:
    """Send what waits for a member, until it has to leave."""
    with suppress(WebSocketException):
        while not member.leaving:
            await has_work.wait()
            has_work.clear()
            while not member.leaving and (message := member.outbox.take()) is not None:
                await socket.send(message)
        await socket.close(TRY_LATER, member.leaving)


def _tls_context(certificate: str, key: str | None) -> ssl.SSLContext:
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        context.load_cert_chain(certificate, key or None, password=lambda: "")
    except (OSError, ValueError) as error:
        raise LinkError(f"using the certificate {certificate} failed: {error}") from error
    return context
