"""A change of keys under way, as both ends see it, and the events that the node applies to its channels.

SETUP_SIGNING is never acknowledged, and whoever changes his key alone is deaf. So both ends listen to the old
and the new key while a change is open, the server decides, and the client speaks as it is spoken to:

    client                                         server
    listens to both, asks, signed the old way  ──► may it? signs the new way, listens to both
    hears the new way: signs the new way       ──► hears the new way: done; the old key is forgotten
    hears an answer to that: done                  hears no such thing for TRIAL seconds: all as before
    hears the old way again: so does it, and after QUIET seconds without asking that is the end of it

Each line may be lost, and the change outlives the operation that began it, until the client knows what the
server does. An autopilot without such a trial changes at once, which the client cannot tell from one with it.

The old way and the new way are each a key, or None for unsigned.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.security.timestamps import time_if_set
from mavstack.services.service import Event
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.security import SigningKey
    from mavstack.services.addressing import Address
    from mavstack.wire import Packet

#: For so long the server waits to hear the new way before it goes back.
TRIAL = 10.0
#: So long after it last asked the client believes what it hears: the trial, and a slow link's delay.
QUIET = 15.0
#: So many packets in a row that are signed with another key are believed to be.
CLEAR = 3


@dataclass(frozen=True, slots=True)
class KeyEvent(Event):
    """Something to do with the keys of the channels that lead to `peer`."""

    peer: Address


@dataclass(frozen=True, slots=True)
class ListenForKey(KeyEvent):
    """Accept from now on also what is signed with the key, or, if it is None, what is not signed.

    `timestamp` is what the asker's signing clock says: who has no clock of its own signs from there on.
    """

    key: SigningKey | None
    timestamp: int = 0


@dataclass(frozen=True, slots=True)
class UseNewKey(KeyEvent):
    """Sign with the key that is listened for; go on listening to the old one."""


@dataclass(frozen=True, slots=True)
class UseOldKey(KeyEvent):
    """Sign as before; go on listening to the new key."""


@dataclass(frozen=True, slots=True)
class KeySettled(KeyEvent):
    """The change is over; only what is used now is accepted.

    If `changed`, the program stores `key`, with which its next run begins; else all is as before and `key`
    is the one that was not taken.
    """

    key: SigningKey | None
    changed: bool


def signed_with(packet: Packet, key: SigningKey | None, now: float) -> bool:
    """Whether the packet is signed with the key, or unsigned if there is none."""
    if key is None or not packet.signed:
        return key is None and not packet.signed
    return bool(Parser(common, signing=key.signing()).feed(packet.raw, time_if_set(now)))


class KeyChange:
    """The client's view of a change: how the target speaks, and whether that is its last word."""

    def __init__(self, peer: Address, new: SigningKey | None, emit: Callable[[Event], None]) -> None:
        self.new = new
        self.speaks_new = False
        self._unclear = 0
        self.settled: bool | None = None
        self.asked_at: float | None = None
        self._peer = peer
        self._emit = emit
        emit(ListenForKey(peer, new))

    def heard(self, packet: Packet, now: float) -> None:
        """Take in a packet of the target."""
        is_new = signed_with(packet, self.new, now)
        if self._is_unclear(packet, is_new):
            return
        if is_new != self.speaks_new:
            self.speaks_new = is_new
            self._emit(UseNewKey(self._peer) if is_new else UseOldKey(self._peer))
        quiet = self.asked_at is not None and now >= self.asked_at + QUIET
        if quiet or (self.asked_at is None and is_new):
            self.settle()

    def _is_unclear(self, packet: Packet, is_new: bool) -> bool:
        """Whether it proves nothing: no checksum covers a signature, a damaged one looks like any."""
        self._unclear = self._unclear + 1 if packet.signed and not is_new else 0
        return 0 < self._unclear < CLEAR

    def settle(self) -> None:
        """What is spoken now is the last word."""
        if self.settled is None:
            self.settled = self.speaks_new
            self._emit(KeySettled(self._peer, self.new, self.settled))
