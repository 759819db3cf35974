"""Short-lived tickets with which a client shows that it knows an API key, without sending the key.

A ticket is the text `v2|scope|issued|expires|nonce|signature`: times in seconds since 1970, a nonce of
16 bytes and the signature in hexadecimal. The signature is the HMAC-SHA256 of the first five fields with a
key that is derived from the API key, so that the API key itself signs nothing. A ticket is for one use: a
verifier keeps the nonces of the tickets that it accepted. A browser cannot send headers with a WebSocket, so
it offers the ticket as a subprotocol, behind `SUBPROTOCOL`, which the server chooses.
"""

from __future__ import annotations

import re
from enum import StrEnum
from hashlib import sha256
from hmac import compare_digest
from hmac import digest as hmac_digest
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Collection

#: The WebSocket subprotocol that a client offers in front of the ticket, and that the server selects.
SUBPROTOCOL: Final = "ados-ws-ticket"
#: The scope of tickets for raw MAVLink packets over a WebSocket.
MAVLINK_SCOPE: Final = "gs.mavlink_ws"
#: Seconds from issue to expiry: the default, and the maximum.
LIFETIME: Final = 30
MAX_LIFETIME: Final = 120
#: Maximum number of nonces that a verifier keeps.
MAX_NONCES: Final = 4096
#: Maximum seconds by which the issuer's clock may be ahead of the verifier's.
MAX_CLOCK_LEAD: Final = 5
_NONCE_SIZE: Final = 16
_KEY_LABEL: Final = b"ados-ws-ticket-v1"
_TICKET: Final = re.compile(
    r"(?P<signed>v2\|(?P<scope>[!-{}~]{1,64})\|(?P<issued>\d{1,12})\|(?P<expires>\d{1,12})"
    r"\|(?P<nonce>[0-9a-f]{32}))"
    r"\|(?P<signature>[0-9a-f]{64})",
    re.ASCII,
)


class TicketRefusal(StrEnum):
    """The reason for which a ticket is refused."""

    MISSING = "a ticket is needed"
    MALFORMED = "the ticket is malformed"
    FORGED = "the signature of the ticket is wrong"
    WRONG_SCOPE = "the ticket is for another scope"
    EXPIRED = "the ticket has expired"
    TOO_LONG = "the ticket is valid for too long"
    IN_FUTURE = "the ticket was issued in the future"
    USED = "the ticket has been used"
    REVOKED = "the ticket is revoked"
    TOO_MANY = "too many tickets are in use"


def make_ticket(
    api_key: str, *, now: float, nonce: bytes, scope: str = MAVLINK_SCOPE, lifetime: int = LIFETIME
) -> str:
    """Make a ticket.

    Args:
        api_key: The key that client and server share.
        now: The time in seconds since 1970.
        nonce: 16 random bytes, different for each ticket.
        scope: What the ticket allows.
        lifetime: Seconds until it expires, 1 to 120.

    Returns:
        The ticket.

    Raises:
        InvalidArgumentError: The lifetime, the nonce or the scope is not allowed.
    """
    if not 1 <= lifetime <= MAX_LIFETIME:
        raise InvalidArgumentError(f"lifetime must be 1 to {MAX_LIFETIME} s, got {lifetime}")
    if len(nonce) != _NONCE_SIZE:
        raise InvalidArgumentError(f"nonce must have {_NONCE_SIZE} bytes, got {len(nonce)}")
    if not re.fullmatch(r"[!-{}~]{1,64}", scope):
        raise InvalidArgumentError(
            f"scope must be 1 to 64 characters of ASCII without spaces and '|', got {scope!r}"
        )
    signed = f"v2|{scope}|{int(now)}|{int(now) + lifetime}|{nonce.hex()}"
    return f"{signed}|{_sign(_derive_key(api_key), signed)}"


def offered_ticket(subprotocols: str) -> str | None:
    """Return the ticket that a client offers.

    Args:
        subprotocols: The header `Sec-WebSocket-Protocol` of the client.

    Returns:
        The ticket, or None if none is offered.
    """
    offered = [word.strip() for word in subprotocols.split(",")]
    if SUBPROTOCOL not in offered[:-1]:
        return None
    return offered[offered.index(SUBPROTOCOL) + 1]


class TicketVerifier:
    """Verifies tickets, each once.

    Args:
        api_key: The key that client and server share.
        scopes: The scopes of which a ticket must have one.
    """

    def __init__(self, api_key: str, scopes: Collection[str] = (MAVLINK_SCOPE,)) -> None:
        self._key = _derive_key(api_key)
        self._scopes = frozenset(scopes)
        #: The expiry time of each accepted ticket, by its nonce.
        self._used: dict[str, int] = {}

    def verify(self, ticket: str, now: float) -> TicketRefusal | None:
        """Verify a ticket and use it up.

        Args:
            ticket: The ticket.
            now: The time in seconds since 1970.

        Returns:
            None if the ticket is valid, else the reason for which it is refused.
        """
        match = _TICKET.fullmatch(ticket)
        if match is None:
            return TicketRefusal.MALFORMED
        if not compare_digest(match["signature"], _sign(self._key, match["signed"])):
            return TicketRefusal.FORGED
        if match["scope"] not in self._scopes:
            return TicketRefusal.WRONG_SCOPE
        return self._check_times(int(match["issued"]), int(match["expires"]), now) or self._use(
            match["nonce"], int(match["expires"]), now
        )

    @staticmethod
    def _check_times(issued: int, expires: int, now: float) -> TicketRefusal | None:
        if now >= expires:
            return TicketRefusal.EXPIRED
        if not 0 < expires - issued <= MAX_LIFETIME:
            return TicketRefusal.TOO_LONG
        if issued > now + MAX_CLOCK_LEAD:
            return TicketRefusal.IN_FUTURE
        return None

    def _use(self, nonce: str, expires: int, now: float) -> TicketRefusal | None:
        if nonce in self._used:
            return TicketRefusal.USED
        if len(self._used) >= MAX_NONCES:
            self._used = {known: end for known, end in self._used.items() if end > now}
        if len(self._used) >= MAX_NONCES:
            return TicketRefusal.TOO_MANY
        self._used[nonce] = expires
        return None


def scope_of(ticket: str) -> str:
    """Return the scope of a ticket that was verified.

    Args:
        ticket: The ticket.

    Returns:
        The scope.
    """
    return ticket.split("|")[1]


def nonce_of(ticket: str) -> bytes:
    """Return the nonce of a ticket that was verified.

    Args:
        ticket: The ticket.

    Returns:
        The 16 bytes with which it was made.
    """
    return bytes.fromhex(ticket.split("|")[4])


def _derive_key(api_key: str) -> bytes:
    return hmac_digest(api_key.encode(), _KEY_LABEL, sha256)


def _sign(key: bytes, text: str) -> str:
    return hmac_digest(key, text.encode(), sha256).hex()
