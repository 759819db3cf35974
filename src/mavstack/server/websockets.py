"""The WebSockets of the station: access, the choice of the subprotocol, and the life of a client."""

from __future__ import annotations

import asyncio
import logging
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING, Final, TypeAlias

from starlette.websockets import WebSocketDisconnect

from mavstack.errors import InvalidStateError
from mavstack.http.bodies import RefusedError
from mavstack.security.tickets import SUBPROTOCOL as TICKET_SUBPROTOCOL
from mavstack.server import json_client, raw_client
from mavstack.server.dispatch import problem_response
from mavstack.server.json_client import JsonClient
from mavstack.server.raw_client import RawClient
from mavstack.server.rows import client as row_client
from mavstack.server.rows.client import RowClient
from mavstack.server.session_end import ending_with_session

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterator

    from starlette.websockets import WebSocket

    from mavstack.security.roles import Role
    from mavstack.server.access import Access
    from mavstack.server.station import Station

logger = logging.getLogger("mavstack.server")

Client: TypeAlias = RawClient | JsonClient | RowClient

_POLICY_VIOLATION: Final = 1008


def websocket_endpoint(station: Station, access: Access) -> Callable[[WebSocket], Awaitable[None]]:
    """Return the function that Starlette calls for each WebSocket."""

    async def endpoint(websocket: WebSocket) -> None:
        try:
            offered = websocket.scope.get("subprotocols", [])
            chosen = choose_subprotocol(offered)
            role, session = known = access.check_websocket(websocket.headers, websocket.cookies)
            place = ExitStack()
            place.enter_context(station.shares.place(known))
        except RefusedError as error:
            await _deny(websocket, error)
            return
        # Both exceptions are normal: the client may leave, and the station may be closed, at any time.
        with place, suppress(WebSocketDisconnect, InvalidStateError):
            await websocket.accept(chosen)
            client = _client(station, websocket, chosen, role)
            async with ending_with_session(access, session):
                await _serve(station, websocket, client, used=lambda: access.role_of(session))
                return
            await websocket.close(_POLICY_VIOLATION, "the session has ended: log in again")

    return endpoint


def choose_subprotocol(offered: list[str]) -> str | None:
    """Return the subprotocol of the answer; raw packets are the default.

    Args:
        offered: The subprotocols that the client offers; a ticket follows `ados-ws-ticket`.

    Returns:
        The subprotocol, or None if the client offers none.

    Raises:
        RefusedError: The client offers only others.
    """
    known = (raw_client.SUBPROTOCOL, json_client.SUBPROTOCOL, row_client.SUBPROTOCOL, TICKET_SUBPROTOCOL)
    chosen = next((each for each in known if each in offered), None)
    if offered and chosen is None:
        raise RefusedError(400, f"the subprotocols are {', '.join(known[:3])}")
    return chosen


def _client(station: Station, websocket: WebSocket, subprotocol: str | None, role: Role) -> Client:
    if subprotocol == row_client.SUBPROTOCOL:
        return RowClient(station.sources.rows, websocket)
    kind = JsonClient if subprotocol == json_client.SUBPROTOCOL else RawClient
    return kind(station, websocket, role)


@contextmanager
def _joined(station: Station, client: Client) -> Iterator[None]:
    """Hand packets or rows to a client while the context is open."""
    if isinstance(client, RowClient):
        station.sources.rows.clients.add(client)
    else:
        station.packets.clients.add(client)
    try:
        yield
    finally:
        if isinstance(client, RowClient):
            station.sources.rows.clients.discard(client)
        else:
            station.packets.clients.discard(client)


async def _serve(
    station: Station, websocket: WebSocket, client: Client, *, used: Callable[[], object]
) -> None:
    """Send and receive until the client leaves; `used` is called for each message of the client."""
    sender = asyncio.get_running_loop().create_task(client.send())
    # If a send fails, the client has left, and `receive` ends too: the error needs no report.
    sender.add_done_callback(lambda task: None if task.cancelled() else task.exception())
    try:
        with _joined(station, client):
            while True:
                event = await websocket.receive()
                if event["type"] == "websocket.disconnect":
                    return
                used()
                data: str | bytes | None = event.get("bytes")
                await client.receive(event.get("text", "") if data is None else data)
    finally:
        sender.cancel()
        await asyncio.gather(sender, return_exceptions=True)
        if client.queue.dropped:
            logger.info("a WebSocket client was too slow for %d packets or rows", client.queue.dropped)


async def _deny(websocket: WebSocket, error: RefusedError) -> None:
    if "websocket.http.response" in websocket.scope.get("extensions", {}):
        await websocket.send_denial_response(problem_response(error))
    else:
        await websocket.close(_POLICY_VIOLATION, str(error)[:120])
