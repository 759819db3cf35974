"""The rooms of a relay, without sockets and clock.

A member is one connection with a valid ticket. A room has one host; a newer connection with a ticket for the
host's seat replaces the older one, because a vehicle that lost its network comes back before its old
connection is known to be dead. Guests that come before the host wait for it.

Everything is bounded: members of the relay and guests of a room (`mavstack.security.admission`; the
place of a member that is in use is not taken away), the bytes of each sender that wait for a member, and the
pace of each member. A member that sends faster is read more slowly, so that the flood stays in its own
connection; a datagram that finds its queue full is dropped and counted.
"""

from __future__ import annotations

from collections import Counter, deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from mavstack.links.relay_frames import (
    MAX_DATAGRAM,
    Change,
    GuestDatagram,
    decode,
    encode_datagram,
    encode_notice,
)
from mavstack.security.admission import Admission, Place, Proof
from mavstack.security.room_tickets import Seat

if TYPE_CHECKING:
    from collections.abc import Callable

#: The number of bytes added to the size of each datagram, because each datagram takes time.
MESSAGE_COST: Final = 256
#: Seconds of its allowed rate that a member may send at once.
BURST_SECONDS: Final = 1.0
_RELAY: Final = 0


@dataclass(frozen=True, slots=True)
class Limits:
    """The bounds of a relay.

    Attributes:
        members: Connections at the same time.
        guests: Guests of one room.
        queue: Bytes of one sender that wait for one member.
        pace: Bytes per second that one member may send.
    """

    members: int = 256
    guests: int = 16
    queue: int = 64 << 10
    pace: int = 512 << 10


@dataclass(slots=True, eq=False)
class Member:
    """One connection of a room.

    Attributes:
        room: The name of the room.
        seat: Its seat.
        address: The address from which it came.
        number: The number of a guest; 0: the host.
        used_at: The time of its last datagram; before any, of its coming.
        wake: Called when a datagram waits for it, or it has to leave.
        leaving: The reason for which it has to leave; empty: it may stay.
        outbox: The messages that wait for it.
        debt_until: The time until which it is not read.
    """

    room: str
    seat: Seat
    address: str
    number: int
    used_at: float
    wake: Callable[[], None]
    outbox: Outbox
    leaving: str = ""
    debt_until: float = 0.0


class Outbox:
    """The messages for one member, with a queue for each sender; the senders take turns.

    Args:
        limit: Bytes of one sender that may wait.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._queues: dict[int, deque[bytes]] = {}
        self._sizes: Counter[int] = Counter()

    def put(self, sender: int, message: bytes) -> bool:
        """Queue a message of a sender; return False if too many bytes of it wait."""
        if self._sizes[sender] + len(message) > self._limit:
            return False
        self._queues.setdefault(sender, deque()).append(message)
        self._sizes[sender] += len(message)
        return True

    def take(self) -> bytes | None:
        """Return the next message, of the sender that was served longest ago; None: nothing waits."""
        if not self._queues:
            return None
        sender = next(iter(self._queues))
        queue = self._queues.pop(sender)
        message = queue.popleft()
        self._sizes[sender] -= len(message)
        if queue:
            self._queues[sender] = queue
        else:
            del self._sizes[sender]
        return message


@dataclass(slots=True)
class _Room:
    admission: Admission
    host: Member | None = None
    guests: dict[int, Member] = field(default_factory=dict)
    last_number: int = 0


class Rooms:
    """All rooms of a relay.

    Args:
        limits: The bounds.

    Attributes:
        counts: Events by name: datagrams that were forwarded and dropped, members that came and were refused.
    """

    def __init__(self, limits: Limits | None = None) -> None:
        self.limits = limits or Limits()
        self.counts: Counter[str] = Counter()
        self._rooms: dict[str, _Room] = {}
        self._members: set[Member] = set()
        self._admission = Admission(self.limits.members, min_stay=0)

    @property
    def members(self) -> int:
        """Number of connections."""
        return len(self._members)

    @property
    def names(self) -> list[str]:
        """The names of the rooms with a member."""
        return sorted(self._rooms)

    def join(self, name: str, seat: Seat, address: str, wake: Callable[[], None], now: float) -> Member | str:
        """Add a connection whose ticket is valid.

        Args:
            name: The name of the room.
            seat: The seat of the ticket.
            address: The address of the connection.
            wake: Called when something waits for the member, or it has to leave.
            now: The time in seconds.

        Returns:
            The member, or the reason why there is no place for it.
        """
        room = self._rooms.get(name) or _Room(Admission(self.limits.guests, min_stay=0))
        older = room.host if seat is Seat.HOST else None
        if older is None:  # a host that returns replaces its older connection
            refusal = self._make_room(room, name, seat, address, now)
            if refusal:
                self.counts["refused"] += 1
                return refusal
        else:
            self.dismiss(older, "replaced by a newer connection of the host")
        self._rooms[name] = room
        member = Member(name, seat, address, 0, now, wake, Outbox(self.limits.queue))
        self._members.add(member)
        self.counts["came"] += 1
        self._seat(room, member)
        return member

    def leave(self, member: Member) -> None:
        """Remove a connection that has ended. Idempotent."""
        if member not in self._members:
            return
        self._members.discard(member)
        room = self._rooms[member.room]
        if room.host is member:
            room.host = None
        elif room.guests.pop(member.number, None) is not None:
            self._notify(room, Change.LEFT, member.number)
        if room.host is None and not room.guests:
            del self._rooms[member.room]

    def receive(self, member: Member, message: bytes, now: float) -> float:
        """Forward a message of a member.

        Args:
            member: The sender.
            message: The message.
            now: The time in seconds.

        Returns:
            The seconds for which the member must not be read, because it sends faster than its pace.
        """
        if member not in self._members:
            return 0.0
        member.used_at = now
        target, content = self._route(self._rooms[member.room], member, message)
        if target is None or not target.outbox.put(member.number, content):
            self.counts["dropped"] += 1
        else:
            self.counts["forwarded"] += 1
            target.wake()
        return self._debt(member, len(message), now)

    def _route(self, room: _Room, member: Member, message: bytes) -> tuple[Member | None, bytes]:
        """Return the receiver of a message, or None, and the message as the receiver gets it."""
        if member.seat is Seat.GUEST:
            fits = len(message) <= MAX_DATAGRAM
            return (room.host if fits else None), encode_datagram(member.number, message)
        match decode(message):
            case GuestDatagram(guest, data):
                return room.guests.get(guest), data
        return None, b""

    def _debt(self, member: Member, size: int, now: float) -> float:
        cost = (size + MESSAGE_COST) / self.limits.pace
        member.debt_until = max(member.debt_until, now - BURST_SECONDS) + cost
        return max(0.0, member.debt_until - now)

    def _make_room(self, room: _Room, name: str, seat: Seat, address: str, now: float) -> str:
        """Find a place for a member; return the reason if there is none."""
        if seat is Seat.GUEST:
            guests = [_place(each, each.address) for each in room.guests.values()]
            decision = room.admission.admit(address, guests, now, Proof.AUTHENTICATED)
            if not decision.admitted:
                return "the room is full"
            if decision.leaving is not None:
                self.dismiss(decision.leaving, "closed to make room for another guest")
                return ""
        everybody = [_place(each, each.room) for each in self._members]
        decision = self._admission.admit(name, everybody, now, Proof.AUTHENTICATED)
        if not decision.admitted:
            return "the relay is full"
        if decision.leaving is not None:
            self.dismiss(decision.leaving, "closed to make room for another member")
        return ""

    def dismiss(self, member: Member, reason: str) -> None:
        """Let a member leave for a reason, which it is sent."""
        member.leaving = reason
        self.leave(member)
        member.wake()

    def _seat(self, room: _Room, member: Member) -> None:
        if member.seat is Seat.HOST:
            room.host = member
            for number in room.guests:
                self._notify(room, Change.CAME, number)
            return
        room.last_number += 1
        member.number = room.last_number
        room.guests[member.number] = member
        self._notify(room, Change.CAME, member.number)

    @staticmethod
    def _notify(room: _Room, change: Change, number: int) -> None:
        if room.host is not None and room.host.outbox.put(_RELAY, encode_notice(change, number)):
            room.host.wake()


def _place(member: Member, holder: str) -> Place[Member]:
    return Place(member, holder, Proof.AUTHENTICATED, member.used_at)
