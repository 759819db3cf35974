"""A driver of one service without a network: packets in, messages out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.service import always_room
from mavstack.wire import Packet, encode

if TYPE_CHECKING:
    from random import Random

    from mavstack.services import Address


def packet(message, source: Address, sequence: int = 0) -> Packet:
    data = encode(message, system=source.system, component=source.component, sequence=sequence)
    return Packet(data, common)


def give(service, message, source: Address, now: float, sequence: int = 0) -> None:
    service.receive(packet(message, source, sequence), now)


def sent(service, now: float, has_room=always_room) -> list:
    return [outgoing.message for outgoing in service.messages_to_send(now, has_room)]


def pass_time(service, until: float) -> list[tuple[float, object]]:
    """Fire the service's timers up to a time; return the (time, message) pairs that it sent."""
    out = []
    while (due := service.next_timeout()) is not None and due <= until:
        service.handle_timeout(due)
        out += [(due, message) for message in sent(service, due)]
    return out


def garbage(kind, random: Random):
    """Return a message of `kind` with random bytes."""
    return kind.from_payload(random.randbytes(random.choice([0, 1, 255])))
