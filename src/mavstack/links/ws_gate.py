"""The gate of a WebSocket server: it decides which clients may open a WebSocket.

With `token=…` or `ticket_key=…` a client must show the token or a ticket of that key; with both, one of them
is enough. Tickets are described in `mavstack.security.tickets`: a client offers the subprotocols
`ados-ws-ticket` and the ticket, and the server chooses the first. The scope of a ticket is
`gs.mavlink_ws`, or, for one role alone, `gs.mavlink_ws.observe`, `.operate` or `.administer`. Refused clients
get HTTP 401, or 403 if they are known but not allowed, and are counted by reason.
"""

from __future__ import annotations

from collections import Counter
from hmac import compare_digest
from http import HTTPStatus
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.errors import LinkError, SigningError
from mavstack.security.api_keys import read_api_key
from mavstack.security.roles import Role
from mavstack.security.tickets import MAVLINK_SCOPE, TicketRefusal, TicketVerifier, offered_ticket, scope_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links.channel import Request
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

#: The role of each ticket scope.
SCOPES: Final = MappingProxyType(
    {MAVLINK_SCOPE: Role.ADMINISTER} | {f"{MAVLINK_SCOPE}.{role.word}": role for role in Role}
)
#: Refusals of clients with a valid ticket.
_NOT_ALLOWED = frozenset({TicketRefusal.WRONG_SCOPE, TicketRefusal.TOO_MANY})


class Refused(NamedTuple):
    """The answer to a client that is refused."""

    status: HTTPStatus
    reason: str


class WsGate:
    """Decides on the clients of one WebSocket server."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        self._token = options.text("token")
        api_key = ticket_key(url, options)
        self._tickets = TicketVerifier(api_key, SCOPES) if api_key else None
        #: The program's own check: returns None to accept a client, or the reason to refuse it.
        self.accept: Callable[[Request], str | None] | None = None
        #: Number of refused clients by reason; all clients that `accept` refused count under one reason.
        self.refusals: Counter[str] = Counter()

    @property
    def takes_tickets(self) -> bool:
        """True if clients may show tickets."""
        return self._tickets is not None

    def check(self, request: Request, subprotocols: str, now: float) -> Refused | Role:
        """Decide on a client: return the role of its credentials, or the refusal; use up its ticket."""
        decision = self._check_credentials(request, subprotocols, now)
        if isinstance(decision, Refused):
            self.refusals[decision.reason] += 1
            return decision
        reason = self.accept(request) if self.accept is not None else None
        if reason is None:
            return decision
        self.refusals["refused by the program"] += 1
        return Refused(HTTPStatus.FORBIDDEN, reason)

    def _check_credentials(self, request: Request, subprotocols: str, now: float) -> Refused | Role:
        if self._token and compare_digest(_shown_token(request).encode(), self._token.encode()):
            return Role.ADMINISTER
        if self._tickets is None:
            refused = Refused(HTTPStatus.UNAUTHORIZED, "a valid token is needed")
            return refused if self._token else Role.ADMINISTER
        ticket = offered_ticket(subprotocols)
        if ticket is None:
            return Refused(HTTPStatus.UNAUTHORIZED, TicketRefusal.MISSING)
        refusal = self._tickets.verify(ticket, now)
        if refusal is None:
            return SCOPES[scope_of(ticket)]
        forbidden = refusal in _NOT_ALLOWED
        return Refused(HTTPStatus.FORBIDDEN if forbidden else HTTPStatus.UNAUTHORIZED, refusal)


def ticket_key(url: LinkURL, options: Options) -> str:
    """Return the API key that the option `ticket_key` names, or an empty text; raises `LinkError`."""
    name = options.text("ticket_key")
    try:
        return read_api_key(name) if name else ""
    except SigningError as error:
        raise LinkError(f"cannot open {url.redacted}: {error}") from None


def _shown_token(request: Request) -> str:
    scheme, _, token = request.headers.get("authorization", "").partition(" ")
    return token.strip() if scheme.lower() == "bearer" else request.query.get("access_token", "")
