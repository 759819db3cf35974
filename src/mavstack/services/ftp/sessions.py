"""The state of an FTP server: open files, and the last replies to each client."""

from __future__ import annotations

from collections import Counter, OrderedDict
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.security.admission import Admission, Place, Proof

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.dialects import Message
    from mavstack.services.addressing import Address
    from mavstack.services.ftp.payload import FtpPayload
    from mavstack.services.ftp.stores import OpenFile

MAX_SESSIONS, MAX_SESSIONS_PER_CLIENT = 64, 4
MAX_CLIENTS = 64
#: Seconds without a request after which a session is closed, normally and while all sessions are in use.
IDLE_TIMEOUT, IDLE_TIMEOUT_WHEN_FULL = 15.0, 3.0
#: Seconds for which a client keeps its only session while all are in use and another client has none.
MIN_SESSION_DURATION = 3.0
#: The largest number of cached replies to one client, which may have several outstanding requests, and the
#: seconds for which replies are kept: replies to modifying requests as long as a client may repeat the
#: request, other replies only as long as duplicate packets may arrive.
MAX_REPLIES, REPLY_LIFETIME, SHORT_REPLY_LIFETIME = 256, 60.0, 3.0
#: Seconds for which replies are kept after the end of a session: the client may then reuse sequence numbers,
#: and duplicate packets arrive sooner than this.
REPLY_LIFETIME_AFTER_SESSION = 1.0


@dataclass(slots=True)
class Burst:
    """A burst in progress."""

    sequence: int
    offset: int
    size: int
    ends_at: float
    packets: int = 0


@dataclass(slots=True, eq=False)
class Session:
    """An open file of one client."""

    number: int
    owner: Address
    file: OpenFile
    writable: bool
    used_at: float
    opened_at: float
    burst: Burst | None = None
    authenticated: bool = False

    def place(self) -> Place[Session]:
        """Return the place of the session in the table."""
        proof = Proof.AUTHENTICATED if self.authenticated else Proof.SPEAKING
        return Place(self, str(self.owner), proof, self.used_at)


class Sessions:
    """The open files, a bounded number, of which each client gets a fair share.

    The client chooses the number of its session in the request that opens it, as with ArduPilot: some clients
    ignore the number in the reply, or expect the one that they sent.
    """

    def __init__(self) -> None:
        self._open: OrderedDict[tuple[Address, int], Session] = OrderedDict()
        self._admission = Admission(MAX_SESSIONS, timeout=IDLE_TIMEOUT_WHEN_FULL)

    def __iter__(self) -> Iterator[Session]:
        return iter(tuple(self._open.values()))

    def __len__(self) -> int:
        return len(self._open)

    def find(self, number: int, owner: Address) -> Session | None:
        """Return a client's session."""
        return self._open.get((owner, number))

    def make_room(self, owner: Address, number: int, now: float, *, authenticated: bool = False) -> bool:
        """Return whether a session can be opened under a number; closes another one if necessary.

        Args:
            owner: The client.
            number: The number of the session.
            now: Unix time in seconds.
            authenticated: The packets of the client have valid signatures. Its sessions replace those of
                other clients, and only authenticated clients replace them.

        Returns:
            True if it can.
        """
        known = self._open.get((owner, number))
        own = [session for session in self._open.values() if session.owner == owner]
        if known is not None:
            replaced = _idle([known], now)
        elif len(own) >= MAX_SESSIONS_PER_CLIENT:
            replaced = _idle(own, now)
        elif len(self._open) < MAX_SESSIONS:
            return True
        else:
            replaced = self._replaceable(owner, len(own), now, authenticated=authenticated)
        if replaced is None:
            return False
        self.drop(replaced)
        return True

    def _replaceable(
        self, owner: Address, number_of_own: int, now: float, *, authenticated: bool
    ) -> Session | None:
        """Return the session that a client with this number of sessions may replace; None: it must wait."""
        if authenticated:
            places = [session.place() for session in self._open.values()]
            leaving = self._admission.admit(str(owner), places, now, Proof.AUTHENTICATED).leaving
            if leaving is not None:
                return leaving
        sessions = [session for session in self._open.values() if authenticated or not session.authenticated]
        if not sessions:
            return None
        idle = _idle(sessions, now)
        if idle is not None:
            return idle
        shares = Counter(session.owner for session in sessions)
        largest, share = shares.most_common(1)[0]
        if share > number_of_own + 1:
            return min((each for each in sessions if each.owner == largest), key=lambda each: each.used_at)
        first = min(sessions, key=lambda session: session.opened_at)
        long = now - first.opened_at >= MIN_SESSION_DURATION
        return first if not number_of_own and long else None

    def bursting(self) -> list[Session]:
        """Return the sessions with a burst, those that waited longest first."""
        return [session for session in self._open.values() if session.burst is not None]

    def served(self, session: Session) -> None:
        """Record that a session sent a packet of its burst: all others come before it."""
        self._open.move_to_end((session.owner, session.number))

    def add(
        self,
        owner: Address,
        number: int,
        file: OpenFile,
        now: float,
        *,
        writable: bool,
        authenticated: bool = False,
    ) -> Session:
        """Add a session under the client's number; see `make_room`."""
        session = Session(number, owner, file, writable, now, now, authenticated=authenticated)
        self._open[owner, number] = session
        return session

    def close(self, session: Session) -> None:
        """Close a session; raises OSError if the written data cannot be stored."""
        del self._open[session.owner, session.number]
        session.file.close()

    def drop(self, session: Session) -> None:
        """Close a session and ignore failures, since no client waits for them."""
        with suppress(OSError):
            self.close(session)

    def close_idle(self, now: float) -> None:
        """Close idle sessions."""
        for session in self:
            if now - session.used_at >= IDLE_TIMEOUT:
                self.drop(session)

    def next_timeout(self) -> float | None:
        """Return when a session may have become idle."""
        return min((session.used_at + IDLE_TIMEOUT for session in self._open.values()), default=None)


def _idle(sessions: Iterable[Session], now: float) -> Session | None:
    """Return the session that is idle longest, if that is long enough to replace it."""
    session = min(sessions, key=lambda session: session.used_at)
    return session if now - session.used_at >= IDLE_TIMEOUT_WHEN_FULL else None


@dataclass(slots=True)
class CachedReply:
    """A reply and its request."""

    request: FtpPayload
    message: Message
    until: float


@dataclass(slots=True)
class ReplyCache:
    """The last replies to each client, so that repeated requests are not executed again."""

    _clients: OrderedDict[Address, OrderedDict[int, CachedReply]] = field(default_factory=OrderedDict)

    def find(self, source: Address, request: FtpPayload, now: float) -> Message | None:
        """Return the reply to an identical request, if it was answered recently."""
        replies = self._clients.get(source)
        known = None if replies is None else replies.get(request.sequence)
        if known is None or known.request != request or now > known.until:
            return None
        return known.message

    def add(self, source: Address, request: FtpPayload, message: Message, now: float, *, long: bool) -> None:
        """Store a reply; `long` is True for modifying requests."""
        replies = self._clients.setdefault(source, OrderedDict())
        self._clients.move_to_end(source)
        replies[request.sequence] = CachedReply(
            request, message, now + (REPLY_LIFETIME if long else SHORT_REPLY_LIFETIME)
        )
        replies.move_to_end(request.sequence)
        while len(replies) > MAX_REPLIES:
            replies.popitem(last=False)
        while len(self._clients) > MAX_CLIENTS:
            self._clients.popitem(last=False)

    def expire_soon(self, source: Address, now: float) -> None:
        """Let all replies to a client expire soon, because its session has ended."""
        for reply in self._clients.get(source, OrderedDict[int, CachedReply]()).values():
            reply.until = min(reply.until, now + REPLY_LIFETIME_AFTER_SESSION)
