"""Tickets for the rooms of a relay: who may take which seat of which room, and until when.

A ticket is the text `room1.ROOM.SEAT.EXPIRES.SIGNATURE`: the name of the room, `host` or `guest`, the expiry
in seconds since 1970, and the HMAC-SHA256 of the text before it, with a key that is derived from the key of
the relay. The relay needs no list of rooms: a valid ticket is enough. A ticket is used as often as its holder
connects again, until it expires; a new key of the relay ends all of them. A ticket opens a room, and no
packet in it: the packets are sealed with a secret that the relay never receives. One ticket alone is ended by
the list of `mavstack.relay.revocations`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import StrEnum
from hashlib import sha256
from hmac import compare_digest
from hmac import digest as hmac_digest
from typing import Final

from mavstack.errors import InvalidArgumentError
from mavstack.security.tickets import TicketRefusal

#: Maximum seconds until the expiry of a ticket: a stolen ticket must not be valid for ever.
MAX_LIFETIME: Final = 400 * 86_400
_ROOM: Final = re.compile(r"[a-z0-9](?:[a-z0-9-]{0,30}[a-z0-9])?", re.ASCII)
_TICKET: Final = re.compile(
    r"(?P<signed>room1\.(?P<room>[a-z0-9-]{1,32})\.(?P<seat>host|guest)\.(?P<expires>\d{1,12}))"
    r"\.(?P<signature>[0-9a-f]{64})",
    re.ASCII,
)
_KEY_LABEL: Final = b"mavstack relay, room tickets"


class Seat(StrEnum):
    """A seat of a room: one host, a vehicle or an agent, and its guests."""

    HOST = "host"
    GUEST = "guest"


@dataclass(frozen=True, slots=True)
class RoomTicket:
    """The content of a valid ticket.

    Attributes:
        room: The name of the room.
        seat: The seat that its holder may take.
        expires: The expiry in seconds since 1970.
    """

    room: str
    seat: Seat
    expires: int


def make_room_ticket(api_key: str, room: str, seat: Seat, *, expires: float) -> str:
    """Make a ticket.

    Args:
        api_key: The key of the relay.
        room: The name of the room: 1 to 32 lower-case letters, digits and hyphens.
        seat: The seat that the holder may take.
        expires: The expiry in seconds since 1970.

    Returns:
        The ticket.

    Raises:
        InvalidArgumentError: The name of the room is not allowed.
    """
    if not _ROOM.fullmatch(room):
        raise InvalidArgumentError(
            f"room must be 1 to 32 lower-case letters, digits and hyphens, got {room!r}"
        )
    signed = f"room1.{room}.{seat}.{int(expires)}"
    return f"{signed}.{_sign(_derive_key(api_key), signed)}"


class RoomTickets:
    """Verifies the tickets of one relay.

    Args:
        api_key: The key of the relay.
    """

    def __init__(self, api_key: str) -> None:
        self._key = _derive_key(api_key)

    def verify(self, ticket: str, now: float) -> RoomTicket | TicketRefusal:
        """Verify a ticket.

        Args:
            ticket: The ticket.
            now: The time in seconds since 1970.

        Returns:
            The content of a valid ticket, else the reason for which it is refused.
        """
        match = _TICKET.fullmatch(ticket)
        if match is None:
            return TicketRefusal.MALFORMED
        if not compare_digest(match["signature"], _sign(self._key, match["signed"])):
            return TicketRefusal.FORGED
        expires = int(match["expires"])
        if now >= expires:
            return TicketRefusal.EXPIRED
        if expires > now + MAX_LIFETIME:
            return TicketRefusal.TOO_LONG
        return RoomTicket(match["room"], Seat(match["seat"]), expires)


def read_room(ticket: str) -> tuple[str, Seat]:
    """Return the room and the seat that a ticket names, without verifying it.

    Raises:
        InvalidArgumentError: The text is not a ticket.
    """
    match = _TICKET.fullmatch(ticket)
    if match is None:
        raise InvalidArgumentError("this is not a ticket of a relay, nor a URL with one")
    return match["room"], Seat(match["seat"])


def _derive_key(api_key: str) -> bytes:
    return hmac_digest(api_key.encode(), _KEY_LABEL, sha256)


def _sign(key: bytes, text: str) -> str:
    return hmac_digest(key, text.encode(), sha256).hex()
