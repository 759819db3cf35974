"""The interface of every service, client or server: a state machine without sockets, threads or clock.

The driver of a service (the node's engine, or a test in virtual time) calls its methods:

    receive(packet, now)             for each packet whose id is in `handles` and that is addressed to `local`
    messages_to_send(now, has_room)  after each other call: yields the messages to send, made one by one
    events()                         after each other call: returns the events since the last time
    next_timeout()                   after each other call: returns when to call `handle_timeout`; None: never
    handle_timeout(now)              when that time has come
    handle_refusal(error, now)       if a message was not sent, since several vehicles use its target's id
    clear_cache(now)                 after the remote component rebooted

`now` is in Unix seconds and never decreases. Small messages (a command, an acknowledgement, a request) go
through an outbox and are always sent. A long transfer overrides `bulk_messages` and makes each message only
when `has_room(target)` says that the links to that target have room for it: so the queue of a slow radio
never grows, and a heartbeat or a command never waits behind a file. A service that found no room is called
again when there is room.
"""

from __future__ import annotations

from collections import deque
from enum import IntEnum
from typing import TYPE_CHECKING, NamedTuple, Protocol

from mavstack.services.addressing import BROADCAST, Address

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message
    from mavstack.errors import SystemIdConflictError
    from mavstack.wire import Packet


class Priority(IntEnum):
    """The order of messages on a link without room for all of them."""

    CONTROL = 0  # heartbeats, commands, acknowledgements, requests
    STREAM = 1  # telemetry and setpoints, useless when late
    BULK = 2  # transfers, which can wait


class Outgoing(NamedTuple):
    """A message to send, the address that it is routed to, its priority, and the name of its only channel.

    Without a name it goes over the channels of the route.
    """

    message: Message
    target: Address = BROADCAST
    priority: Priority = Priority.CONTROL
    channel: str = ""


class HasRoom(Protocol):
    """Returns whether the links to a target, or one named channel, have room for a message now."""

    def __call__(self, target: Address, priority: Priority = Priority.BULK, channel: str = "", /) -> bool: ...


def always_room(target: Address, priority: Priority = Priority.BULK, channel: str = "", /) -> bool:
    """Return True: the links of tests are not limited."""
    return True


class Event:
    """Base of all events of services; each is a frozen dataclass."""

    __slots__ = ()


class Service:
    """The base of services; each of them is one state machine.

    Args:
        local: The address of the local component.
    """

    #: The ids of the messages that the service receives; the set may change.
    handles: frozenset[int] = frozenset()
    #: The only address whose packets the service receives; component 0 means all components of the system.
    source_filter: Address = BROADCAST
    #: True if the service also receives packets with its own address.
    accepts_own_packets = False
    #: True if the service also receives packets of the senders that the program did not choose, if several
    #: senders use one system id.
    observes_all_senders = False

    def __init__(self, local: Address) -> None:
        self.local = local
        self._outbox: deque[Outgoing] = deque()
        self._events: list[Event] = []

    @property
    def is_releasing(self) -> bool:
        """True while it releases state that a remote component keeps, such as an open file."""
        return False

    def receive(self, packet: Packet, now: float) -> bool | None:
        """Handle a packet whose id is in `handles`; its message is never None.

        Returns:
            False if nothing changed: nothing to send, no event, and the same `next_timeout` and `handles` as
            before. A service with many packets returns it to spare the driver the other calls.
        """
        return None

    def messages_to_send(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        """Yield the messages to send now; each counts as sent when it is taken from the iterator."""
        while self._outbox:
            yield self._outbox.popleft()
        yield from self.bulk_messages(now, has_room)

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        """Yield the messages of a long transfer; asks `has_room` before it makes each of them."""
        return iter(())

    def events(self) -> list[Event]:
        """Return the events since the last call."""
        events, self._events = self._events, []
        return events

    def next_timeout(self) -> float | None:
        """Return when to call `handle_timeout`, Unix seconds, or None."""
        return None

    def handle_timeout(self, now: float) -> None:
        """Handle the timers that are due; an early or late call does no harm."""

    def handle_refusal(self, error: SystemIdConflictError, now: float) -> None:
        """Handle that a message was not sent, because several vehicles use the system id of its target."""

    def clear_cache(self, now: float) -> None:
        """Discard the state that was received before a reboot of the remote component."""

    def send(
        self, message: Message, target: Address = BROADCAST, priority: Priority = Priority.CONTROL
    ) -> None:
        """Append a message to the outbox."""
        self._outbox.append(Outgoing(message, target, priority))

    def emit(self, event: Event) -> None:
        """Append an event to those that `events` returns."""
        self._events.append(event)


def earliest(*times: float | None) -> float | None:
    """Return the earliest of the times that are not None."""
    return min((time for time in times if time is not None), default=None)
