"""The one shape of every service, client or server: a state machine without sockets, threads and clock.

Whoever runs it (the node's engine, or a test in virtual time) calls:

    receive(packet, now)              for each packet whose id is in `handles` and that is meant for `local`
    messages_to_send(now, has_room)   after each other call: what it wants to send, made lazily
    events()                          what happened, once
    next_timeout()                    when `handle_timeout(now)` wants to be called; None: not by itself

`now` is in Unix seconds and never goes back. Small messages (a command, an acknowledgement, a request) lie in
an outbox and are always handed over. A long transfer overrides `bulk_messages` and makes each message only
when `has_room(target)` says that the links to that target can take it: so a queue in a slow radio never
grows, and a heartbeat or a command never waits behind a file. Who was told that there is no room is asked
again when there is.
"""

from __future__ import annotations

from collections import deque
from enum import IntEnum
from typing import TYPE_CHECKING, NamedTuple, Protocol

from mavstack.services.addressing import EVERYBODY, Address

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message
    from mavstack.wire import Packet


class Priority(IntEnum):
    """What goes first on a link that cannot take everything."""

    CONTROL = 0  # heartbeats, commands, acknowledgements, requests
    STREAM = 1  # telemetry and setpoints, worthless when late
    BULK = 2  # transfers, which can wait


class Outgoing(NamedTuple):
    """A message to send, and to whom it should be routed."""

    message: Message
    target: Address = EVERYBODY
    priority: Priority = Priority.CONTROL


class HasRoom(Protocol):
    """Whether the links to a target can take a message of that priority now."""

    def __call__(self, target: Address, priority: Priority = Priority.BULK, /) -> bool: ...


def always_room(target: Address, priority: Priority = Priority.BULK, /) -> bool:
    """The links without limits that tests use."""
    return True


class Event:
    """Base of all events of services; each is a frozen dataclass."""

    __slots__ = ()


class Service:
    """A state machine of one service.

    `handles` are the ids of the messages it wants to see, and may change; `hears` is the only address that it
    listens to, if there is one (component 0: any of the system). What bears its own address is not meant for
    it, unless `accepts_own_packets`.
    """

    handles: frozenset[int] = frozenset()
    source_filter: Address = EVERYBODY
    accepts_own_packets = False

    def __init__(self, local: Address) -> None:
        self.local = local
        self._outbox: deque[Outgoing] = deque()
        self._events: list[Event] = []

    def receive(self, packet: Packet, now: float) -> bool | None:
        """Take a packet whose id is in `handles`; its message is never None.

        False says that nothing has changed: nothing to send, no event, and the same `next_timeout` and
        `handles` as before. A service that hears much tells it and spares everyone to look.
        """
        return None

    def messages_to_send(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        """What to send now; each message counts as sent when it is taken from the iterator."""
        while self._outbox:
            yield self._outbox.popleft()
        yield from self.bulk_messages(now, has_room)

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        """What a long transfer sends; asks `has_room` before it makes each message."""
        return iter(())

    def events(self) -> list[Event]:
        """What happened since the last call."""
        events, self._events = self._events, []
        return events

    def next_timeout(self) -> float | None:
        """When to call `handle_timeout`."""
        return None

    def handle_timeout(self, now: float) -> None:
        """Do what is due; calling it early or late does no harm."""

    def send(
        self, message: Message, target: Address = EVERYBODY, priority: Priority = Priority.CONTROL
    ) -> None:
        """Put a message into the outbox."""
        self._outbox.append(Outgoing(message, target, priority))

    def emit(self, event: Event) -> None:
        """Put an event where `events` finds it."""
        self._events.append(event)


def earliest(*times: float | None) -> float | None:
    """The first of the times that are set."""
    return min((time for time in times if time is not None), default=None)
