"""A running relay, and the URLs of its rooms."""

from __future__ import annotations

from contextlib import asynccontextmanager
from time import time
from typing import TYPE_CHECKING, Any

from mavstack.relay.server import RelayServer
from mavstack.security.room_tickets import Seat, make_room_ticket

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mavstack.relay.rooms import Limits

API_KEY = "the key of this relay"
SECRET = "5a" * 32


def ticket(seat: Seat, room: str = "boat", *, api_key: str = API_KEY, lifetime: float = 60) -> str:
    return make_room_ticket(api_key, room, seat, expires=time() + lifetime)


def url(scheme: str, port: int, room: str = "boat", *, secret: str = SECRET, query: str = "") -> str:
    seat = Seat.HOST if scheme == "relayin" else Seat.GUEST
    return f"{scheme}://127.0.0.1:{port}?ticket={ticket(seat, room)}&secret={secret}&tls=no{query}"


@asynccontextmanager
async def relay(limits: Limits | None = None, **more: Any) -> AsyncIterator[tuple[RelayServer, int]]:
    server = RelayServer(API_KEY, limits, **more)
    async with server.serving("127.0.0.1", 0) as port:
        yield server, port
