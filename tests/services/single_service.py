"""Helpers for tests of one service without a network: packets in, messages out."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.services.service import always_room
from mavstack.wire import Parser, encode
from tests.services.network import GROUND, START, VEHICLE

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services import Address, Service
    from mavstack.services.service import HasRoom
    from mavstack.wire import Packet


def packet_of(message: Message, source: Address = VEHICLE, sequence: int = 0) -> Packet:
    """Return the packet of a message, as a parser yields it."""
    data = encode(message, system=source.system, component=source.component, sequence=sequence)
    (packet,) = Parser(common).feed(data)
    return packet


def deliver(service: Service, message: Message, source: Address, now: float, sequence: int = 0) -> None:
    """Let a service receive a message from a component."""
    service.receive(packet_of(message, source, sequence), now)


def sent_by(service: Service, now: float = START, has_room: HasRoom = always_room) -> list[Any]:
    """Return the messages that a service sends; by default over links that take any number of them."""
    return [outgoing.message for outgoing in service.messages_to_send(now, has_room)]


def run_timers(service: Service, until: float) -> list[tuple[float, Any]]:
    """Fire the service's timers up to a time; return the (time, message) pairs that it sent."""
    sent: list[tuple[float, Any]] = []
    while (due := service.next_timeout()) is not None and due <= until:
        service.handle_timeout(due)
        sent += [(due, message) for message in sent_by(service, due)]
    return sent


def random_message(kind: type[Message], random: Random) -> Message:
    """Return a message of this class with random bytes as its payload."""
    return kind.from_payload(random.randbytes(random.choice([0, 1, 255])))


def feed_random_messages(service: Service, kinds: list[type[Message]], seed: int, rounds: int = 60) -> None:
    """Let a service receive messages with random payloads and fire its timers; none may raise."""
    random, now = Random(seed), START
    for _ in range(rounds):
        kind = random.choice(kinds)
        payload = random.randbytes(random.choice([0, 1, 5, 20, 255]))
        if random.random() < 0.5:
            payload = bytes(random.choice([0, 0, 1, 255]) for _ in range(255))
        source = random.choice([VEHICLE, GROUND])
        deliver(service, kind.from_payload(payload), source, now, random.randrange(256))
        sent_by(service, now)
        service.events()
        now += random.choice([0.0, 0.01, 1.0])
        due = service.next_timeout()
        if due is not None and due <= now:
            service.handle_timeout(now)
            sent_by(service, now)
