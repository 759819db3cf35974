"""The messages between a relay and the host of a room: datagrams with the number of a guest in front.

    guest, 4 bytes, big-endian    the datagram, from or to this guest
    0, 4 bytes                    1 (came) or 2 (left), guest, 4 bytes: to the host

The numbers begin with 1 and are not used again while the host is connected. A guest sends and receives plain
datagrams. Each message of the WebSocket is one datagram; the relay may drop any of them, as a network does.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Final, NamedTuple

#: The WebSocket subprotocol of relays; a client offers its ticket as the next subprotocol.
RELAY_PROTOCOL: Final = "mavstack.relay.1"
#: Maximum size of a datagram in bytes.
MAX_DATAGRAM: Final = 16_384
#: Maximum size of a WebSocket message in bytes.
MAX_MESSAGE: Final = MAX_DATAGRAM + 4
_NOTICE_SIZE: Final = 9


class Change(IntEnum):
    """A change among the guests of a room."""

    CAME = 1
    LEFT = 2


class Notice(NamedTuple):
    """The notice that a guest came or left."""

    change: Change
    guest: int


class GuestDatagram(NamedTuple):
    """A datagram from or to a guest."""

    guest: int
    data: bytes


def encode_notice(change: Change, guest: int) -> bytes:
    """Return the message that reports a change to the host."""
    return bytes(4) + bytes((change,)) + guest.to_bytes(4, "big")


def encode_datagram(guest: int, data: bytes) -> bytes:
    """Return a datagram with the number of its guest."""
    return guest.to_bytes(4, "big") + data


def decode(message: bytes) -> Notice | GuestDatagram | None:
    """Return the content of a message between relay and host; None: it is malformed."""
    if len(message) < 4:
        return None
    guest = int.from_bytes(message[:4], "big")
    if guest:
        return GuestDatagram(guest, message[4:])
    if len(message) != _NOTICE_SIZE or message[4] not in (Change.CAME, Change.LEFT):
        return None
    return Notice(Change(message[4]), int.from_bytes(message[5:], "big"))


def offered_room_ticket(subprotocols: str) -> str:
    """Return the ticket that a client offers to a relay.

    Args:
        subprotocols: The header `Sec-WebSocket-Protocol` of the client.

    Returns:
        The ticket; empty: none is offered.
    """
    offered = [word.strip() for word in subprotocols.split(",")]
    return offered[offered.index(RELAY_PROTOCOL) + 1] if RELAY_PROTOCOL in offered[:-1] else ""
