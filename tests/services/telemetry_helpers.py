"""Helpers of several service tests: packets as received, and messages with random fields."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.wire import Parser, encode
from tests.services.network import GROUND, START, VEHICLE

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services import Address, Service
    from mavstack.wire import Packet


def packet_of(message: Message, source: Address = VEHICLE, sequence: int = 0) -> Packet:
    """The message as it comes from the wire."""
    data = encode(message, system=source.system, component=source.component, sequence=sequence)
    (packet,) = Parser(common).feed(data)
    return packet


def sent_by(service: Service, now: float = START) -> list[Message]:
    """Return the messages that a service sends over unlimited links."""
    return [outgoing.message for outgoing in service.messages_to_send(now)]


def feed_garbage(service: Service, kinds: list[type[Message]], seed: int, rounds: int = 60) -> None:
    """Messages of the kinds with any content, and timers, in any order: nothing may raise."""
    random, now = Random(seed), START
    for _ in range(rounds):
        kind = random.choice(kinds)
        payload = random.randbytes(random.choice([0, 1, 5, 20, 255]))
        if random.random() < 0.5:
            payload = bytes(random.choice([0, 0, 1, 255]) for _ in range(255))
        message = kind.from_payload(payload)
        source = random.choice([VEHICLE, GROUND])
        service.receive(packet_of(message, source, random.randrange(256)), now)
        sent_by(service, now)
        service.events()
        now += random.choice([0.0, 0.01, 1.0])
        due = service.next_timeout()
        if due is not None and due <= now:
            service.handle_timeout(now)
            sent_by(service, now)
