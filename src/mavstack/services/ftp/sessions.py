"""What a server remembers: open files, and for each client its last replies."""

from __future__ import annotations

from collections import OrderedDict
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message
    from mavstack.services.addressing import Address
    from mavstack.services.ftp.payload import FtpPayload
    from mavstack.services.ftp.stores import OpenFile

MOST_SESSIONS = 16
MOST_CLIENTS = 64
#: After so long without a request a session is closed, and when all are in use already after the shorter.
IDLE, IDLE_WHEN_FULL = 15.0, 3.0
#: So many replies to one client are remembered (it may have several requests under way): to what changes
#: something for as long as anybody repeats it, to the rest only for copies of a packet.
MOST_REPLIES, MEMORY, SHORT_MEMORY = 256, 60.0, 3.0
#: Once its session has ended a client may begin anew with the same numbers; copies on the way are younger.
MEMORY_AFTER_END = 1.0


@dataclass(slots=True)
class Burst:
    """A burst that is being sent."""

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
    burst: Burst | None = None


class Sessions:
    """The open files; how many there can be is bounded.

    The client chooses the number of its session in the request that opens it, as with ArduPilot: there are
    clients that do not look at what the reply says, or expect in it what they sent.
    """

    def __init__(self) -> None:
        self._open: dict[tuple[Address, int], Session] = {}

    def __iter__(self) -> Iterator[Session]:
        return iter(tuple(self._open.values()))

    def __len__(self) -> int:
        return len(self._open)

    def find(self, number: int, owner: Address) -> Session | None:
        """A client's session."""
        return self._open.get((owner, number))

    def make_place(self, owner: Address, number: int, now: float) -> bool:
        """Whether another fits under a number, if need be in the place of one that is idle."""
        in_the_way = self._open.get((owner, number))
        if in_the_way is None:
            if len(self._open) < MOST_SESSIONS:
                return True
            in_the_way = min(self._open.values(), key=lambda session: session.used_at)
        if now - in_the_way.used_at < IDLE_WHEN_FULL:
            return False
        self.drop(in_the_way)
        return True

    def add(self, owner: Address, number: int, file: OpenFile, now: float, *, writable: bool) -> Session:
        """Open one under the number that the client gave; see `make_place`."""
        session = Session(number, owner, file, writable, now)
        self._open[owner, number] = session
        return session

    def close(self, session: Session) -> None:
        """Close one; raises OSError if what was written to it cannot be kept."""
        del self._open[session.owner, session.number]
        session.file.close()

    def drop(self, session: Session) -> None:
        """Close one where there is nobody to be told of a failure."""
        with suppress(OSError):
            self.close(session)

    def close_idle(self, now: float) -> None:
        """Close those that nobody used for long."""
        for session in self:
            if now - session.used_at >= IDLE:
                self.drop(session)

    def next_timeout(self) -> float | None:
        """When one may have become idle."""
        return min((session.used_at + IDLE for session in self._open.values()), default=None)


@dataclass(slots=True)
class Remembered:
    """A reply, and to what."""

    request: FtpPayload
    message: Message
    until: float


@dataclass(slots=True)
class Memory:
    """The last replies to each client."""

    _clients: OrderedDict[Address, OrderedDict[int, Remembered]] = field(default_factory=OrderedDict)

    def recall(self, source: Address, request: FtpPayload, now: float) -> Message | None:
        """The reply to this very request, if it was answered lately."""
        replies = self._clients.get(source)
        known = None if replies is None else replies.get(request.sequence)
        if known is None or known.request != request or now > known.until:
            return None
        return known.message

    def keep(self, source: Address, request: FtpPayload, message: Message, now: float, *, long: bool) -> None:
        """Remember a reply."""
        replies = self._clients.setdefault(source, OrderedDict())
        self._clients.move_to_end(source)
        replies[request.sequence] = Remembered(request, message, now + (MEMORY if long else SHORT_MEMORY))
        replies.move_to_end(request.sequence)
        while len(replies) > MOST_REPLIES:
            replies.popitem(last=False)
        while len(self._clients) > MOST_CLIENTS:
            self._clients.popitem(last=False)

    def fade(self, source: Address, now: float) -> None:
        """A session has ended: what was said before is soon forgotten."""
        for reply in self._clients.get(source, OrderedDict[int, Remembered]()).values():
            reply.until = min(reply.until, now + MEMORY_AFTER_END)
