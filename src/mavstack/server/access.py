"""Access to the station: passwords, tickets, sessions and roles.

Without a password and a ticket key, every program of this machine administers the station, and the station
listens on loopback only. Two headers then keep pages of other sites out (see `mavstack.http.web_origin`).

Otherwise a client shows a password or a ticket once (`POST /api/session`) and gets a session: a cookie for
pages, and a token for programs (`Authorization: Bearer …`). The role of a session is that of its password or
of the scope of its ticket. For a WebSocket, which cannot have headers in a browser, a session gets tickets
of one use each; a client with the ticket key makes its own. What a session opened ends with it (see
`mavstack.server.session_end`); a WebSocket opened with a client's own ticket is a session by itself.
"""

from __future__ import annotations

import re
import secrets
from contextlib import contextmanager
from dataclasses import dataclass, field
from hmac import compare_digest
from ipaddress import ip_address, ip_network
from time import time
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.errors import InvalidArgumentError
from mavstack.http.bodies import RefusedError
from mavstack.http.web_origin import is_local_host, is_own_origin
from mavstack.links.ws_gate import SCOPES
from mavstack.security.admission import Proof
from mavstack.security.roles import Role
from mavstack.security.tickets import (
    MAVLINK_SCOPE,
    TicketVerifier,
    make_ticket,
    nonce_of,
    offered_ticket,
    scope_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

    from starlette.datastructures import Headers
    from starlette.requests import Request

    from mavstack.http.request_lane import RequestHead

COOKIE: Final = "mavstack_session"
_COOKIE: Final = re.compile(rf"(?:^|;\s*){COOKIE}=\"?([^;\"\s]*)")
#: Seconds after which a session that is not used ends.
SESSION_LIFETIME: Final = 12 * 3600.0
#: Maximum number of sessions of each role; a further one ends the least recently used one.
MAX_SESSIONS: Final = 1024
#: Wrong passwords within `FAILURE_WINDOW` seconds after which an address is blocked for a time.
MAX_FAILURES: Final = 5
FAILURE_WINDOW: Final = 60.0
MAX_FAILING_ADDRESSES: Final = 4096
MIN_PASSWORD: Final = 8
#: Length of the IPv6 prefix of a network: all its addresses count as one machine.
_MACHINE_PREFIX: Final = 64
#: Sizes of the two parts of a ticket's nonce, in bytes: the mark of its session, and random bytes.
_MARK_SIZE: Final = 8
_RANDOM_SIZE: Final = 8
#: Values of the header `Sec-Fetch-Site` of requests that pages of other origins cause.
_OTHER_SITES: Final = ("cross-site", "same-site")


class Client(NamedTuple):
    """A client that may send requests: its role, and the id of its session (empty without one)."""

    role: Role
    session: str = ""

    @property
    def proof(self) -> Proof:
        """The proof of the client: the connections of a session that may act are kept."""
        acts = bool(self.session) and self.role > Role.OBSERVE
        return Proof.AUTHENTICATED if acts else Proof.SPEAKING

    @property
    def holder(self) -> str:
        """The name under which its connections and streams are counted; all observers have one share."""
        return Role.OBSERVE.word if self.role is Role.OBSERVE else self.session


@dataclass(slots=True, eq=False)
class _Session:
    role: Role
    used_at: float
    #: The first bytes of the nonces of the session's tickets, which must not contain the secret token.
    mark: bytes = field(default_factory=lambda: secrets.token_bytes(_MARK_SIZE))
    #: Called when the session ends.
    listeners: set[Callable[[], None]] = field(default_factory=set)


class Access:
    """Decides on the clients of a station.

    Args:
        passwords: The password of each role; a role without one cannot be had by a password.
        ticket_key: The API key of tickets that clients make themselves; empty: none.
        local: The station listens on loopback only.
        origins: Origins of further pages that may send requests, such as `http://localhost:5173`.
        now: Returns the time in seconds since 1970.

    Raises:
        InvalidArgumentError: A password is too short, two roles have one password, or clients of other
            machines would need neither a password nor a ticket.
    """

    def __init__(
        self,
        *,
        passwords: Mapping[Role, str] | None = None,
        ticket_key: str = "",
        local: bool = True,
        origins: Collection[str] = (),
        now: Callable[[], float] = time,
    ) -> None:
        self._passwords = dict(passwords or {})
        self._local = local
        #: Further allowed origins of pages, in the form of the header `Origin`.
        self.origins = frozenset(origin.rstrip("/").lower() for origin in origins)
        self._now = now
        self._sessions: dict[str, _Session] = {}
        self._failures: dict[str, list[float]] = {}
        # Tickets of sessions are signed with a key of this process. They open a WebSocket, not a session.
        self._own_key = secrets.token_hex(32)
        keys = [self._own_key, *filter(None, [ticket_key])]
        self._verifiers = [TicketVerifier(key, SCOPES) for key in keys]
        self._has_ticket_key = bool(ticket_key)
        self._check_settings()

    @property
    def is_open(self) -> bool:
        """True if clients need neither a password nor a ticket."""
        return not self._passwords and not self._has_ticket_key

    def check_request(self, request: Request) -> Client:
        """Return the client of a request.

        Args:
            request: The request.

        Returns:
            The client.

        Raises:
            RefusedError: A page of another site sent it, or the client has no session.
        """
        return self.check_headers(request.headers, request.cookies.get(COOKIE, ""))

    def check_headers(self, headers: Mapping[str, str], cookie: str) -> Client:
        """Return the client of a request by its headers and its cookie; see `check_request`."""
        self.check_page(headers)
        self._check_site(headers)
        return self._client(headers, cookie)

    def comes_first(self, head: RequestHead) -> bool:
        """Return whether a request waits for no others: its session may act.

        Without a password and a ticket key all clients may act; requests that change something come first.
        """
        if self.is_open:
            return head.method not in ("GET", "HEAD")
        role = self.role_of(_token(head.authorization, cookie_of(head.cookie)))
        return role is not None and role > Role.OBSERVE

    def check_websocket(self, headers: Headers, cookies: Mapping[str, str]) -> Client:
        """Return the client of a WebSocket by its ticket or its session, and use up the ticket.

        Args:
            headers: The headers of the request.
            cookies: The cookies of the request.

        Returns:
            The client.

        Raises:
            RefusedError: A page of another site opened it, or the client has neither a ticket nor a session.
        """
        self.check_page(headers)
        ticket = offered_ticket(headers.get("sec-websocket-protocol", ""))
        if ticket is not None and not self.is_open:
            return self._client_of_ticket(ticket)
        return self._client(headers, cookies.get(COOKIE, ""))

    def check_page(self, headers: Mapping[str, str]) -> None:
        """Refuse requests of pages of other sites; raises `RefusedError`."""
        host, origin = headers.get("host", ""), headers.get("origin")
        if self._local and not is_local_host(host):
            raise RefusedError(
                403, "the station serves this machine: use http://localhost or http://127.0.0.1"
            )
        if origin is not None and origin not in self.origins and not is_own_origin(origin, host):
            raise RefusedError(403, "requests of pages of other sites are refused")

    def _check_site(self, headers: Mapping[str, str]) -> None:
        """Refuse requests that a page of another site or port makes without an `Origin`, as for a picture."""
        if "origin" not in headers and headers.get("sec-fetch-site") in _OTHER_SITES:
            raise RefusedError(403, "requests of pages of other sites are refused")

    def log_in(self, address: str, *, password: str | None = None, ticket: str | None = None) -> Client:
        """Begin a session.

        Args:
            address: The address of the client, for the limit on wrong passwords.
            password: The password of a role.
            ticket: A ticket instead of a password.

        Returns:
            The client, with the token of its session.

        Raises:
            RefusedError: The password or the ticket is wrong, or there were too many wrong ones.
        """
        now, address = self._now(), _network_of(address)
        recent = [each for each in self._failures.get(address, ()) if each > now - FAILURE_WINDOW]
        if len(recent) >= MAX_FAILURES:
            raise RefusedError(429, f"too many wrong passwords: wait {FAILURE_WINDOW:g} s")
        try:
            role = (
                self._role_of(password or "") if ticket is None else self._verify(ticket, self._verifiers[1:])
            )
        except RefusedError:
            if len(self._failures) >= MAX_FAILING_ADDRESSES:
                self._failures.clear()
            self._failures[address] = [*recent, now]
            raise
        self._failures.pop(address, None)
        return self._begin(role, now)

    def log_out(self, token: str) -> None:
        """End a session, and what it opened. Idempotent."""
        session = self._sessions.pop(token, None)
        for listener in () if session is None else tuple(session.listeners):
            listener()

    def make_ticket(self, token: str) -> str:
        """Return a ticket of one use with which a page of a session opens a WebSocket."""
        session = self._sessions[token]
        nonce = session.mark + secrets.token_bytes(_RANDOM_SIZE)
        scope = f"{MAVLINK_SCOPE}.{session.role.word}"
        return make_ticket(self._own_key, now=self._now(), nonce=nonce, scope=scope)

    def role_of(self, token: str) -> Role | None:
        """Return the role of a session, and use it; None if there is none."""
        if not self.seconds_left(token):
            return None
        session = self._sessions[token]
        session.used_at = self._now()
        return session.role

    def seconds_left(self, token: str) -> float:
        """Return the seconds until a session ends if it is not used; 0 if there is none."""
        session = self._sessions.get(token)
        left = 0.0 if session is None else session.used_at + SESSION_LIFETIME - self._now()
        if left <= 0.0:
            self.log_out(token)
        return max(left, 0.0)

    @contextmanager
    def listening(self, token: str, listener: Callable[[], None]) -> Iterator[None]:
        """Call a function when a session ends, while the context is open; at once if it has ended."""
        session = self._sessions.get(token)
        if session is None:
            listener()
            yield
            return
        session.listeners.add(listener)
        try:
            yield
        finally:
            session.listeners.discard(listener)

    def _client(self, headers: Mapping[str, str], cookie: str) -> Client:
        if self.is_open:
            return Client(Role.ADMINISTER)
        token = _token(headers.get("authorization", ""), cookie)
        role = self.role_of(token)
        if role is None:
            raise RefusedError(401, "a session is needed: POST /api/session with a password or a ticket")
        return Client(role, token)

    def _client_of_ticket(self, ticket: str) -> Client:
        """Return the client of a WebSocket, with the session from which it has its ticket."""
        try:
            role = self._verify(ticket, self._verifiers[:1])
        except RefusedError:
            if not self._has_ticket_key:
                raise
            return self._begin(self._verify(ticket, self._verifiers[1:]), self._now())
        mark = nonce_of(ticket)[:_MARK_SIZE]
        for token, session in self._sessions.items():
            if session.mark == mark and self.seconds_left(token):
                return Client(role, token)
        raise RefusedError(401, "the session of the ticket has ended: log in again")

    def _role_of(self, password: str) -> Role:
        shown = password.encode()
        found = [role for role, each in self._passwords.items() if compare_digest(each.encode(), shown)]
        if not found:
            raise RefusedError(401, "the password is wrong")
        return max(found)

    def _verify(self, ticket: str, verifiers: Sequence[TicketVerifier]) -> Role:
        refusals = ["tickets are not taken: log in with a password"]
        for verifier in verifiers:
            refusal = verifier.verify(ticket, self._now())
            if refusal is None:
                return SCOPES[scope_of(ticket)]
            refusals.append(str(refusal))
        raise RefusedError(401, refusals[-1])

    def _begin(self, role: Role, now: float) -> Client:
        # The limit is per role, so that sessions of lower roles do not end sessions of higher ones.
        of_role = [token for token, session in self._sessions.items() if session.role is role]
        if len(of_role) >= MAX_SESSIONS:
            self.log_out(min(of_role, key=lambda token: self._sessions[token].used_at))
        token = secrets.token_urlsafe(32)
        self._sessions[token] = _Session(role, now)
        return Client(role, token)

    def _check_settings(self) -> None:
        if not self._local and self.is_open:
            raise InvalidArgumentError("a station that other machines reach needs a password or a ticket key")
        if any(len(password) < MIN_PASSWORD for password in self._passwords.values()):
            raise InvalidArgumentError(f"a password needs {MIN_PASSWORD} characters or more")
        if len(set(self._passwords.values())) < len(self._passwords):
            raise InvalidArgumentError("each role needs a password of its own")


def cookie_of(header: str) -> str:
    """Return the token of a session in a `Cookie` header; empty if there is none."""
    found = _COOKIE.search(header)
    return "" if found is None else found[1]


def _token(authorization: str, cookie: str) -> str:
    """Return the token of a session, of the header or else of the cookie."""
    scheme, _, shown = authorization.partition(" ")
    return shown.strip() if scheme.lower() == "bearer" else cookie


def _network_of(address: str) -> str:
    """Return the network of an IPv6 address, since one machine has all of it; others unchanged."""
    try:
        found = ip_address(address)
    except ValueError:
        return address
    if found.version == 4 or found.ipv4_mapped is not None:
        return address
    return str(ip_network((found.packed, _MACHINE_PREFIX), strict=False))
