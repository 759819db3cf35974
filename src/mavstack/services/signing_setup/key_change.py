"""A key change in progress, on both ends, and the events that the node applies to its channels.

SETUP_SIGNING is not acknowledged, and a component that changes its key alone is cut off. So both ends accept
the old and the new key while a change is in progress; the server decides, and the client follows the server:

    client                                         server
    accepts both, requests, signed the old way ──► allowed? signs the new way, accepts both
    receives the new way: signs the new way    ──► receives the new way: done; the old key is dropped
    receives an answer to that: done               receives none for TRIAL_DURATION seconds: rolls back
    receives the old way again: signs the old way; SETTLED_AFTER seconds after its last request that is final

Each message may be lost, and the change outlives the operation that began it, until the client knows the
state of the server. An autopilot without a trial changes at once, which looks the same to the client.

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

#: Seconds for which the server waits for packets signed with the new key before it rolls back.
TRIAL_DURATION = 10.0
#: Seconds after its last request after which the client takes the server's signing as final: the duration of
#: the trial, and the delay of a slow link.
SETTLED_AFTER = 15.0
#: The number of consecutive packets with another key that prove that the sender uses it.
MIN_PROOF_PACKETS = 3


@dataclass(frozen=True, slots=True)
class KeyEvent(Event):
    """A change of the keys of the channels that lead to `peer`."""

    peer: Address


@dataclass(frozen=True, slots=True)
class ListenForKey(KeyEvent):
    """Also accept packets signed with the key, or unsigned ones if it is None.

    `timestamp` is the client's signing clock: a component without a clock continues from there.
    """

    key: SigningKey | None
    timestamp: int = 0


@dataclass(frozen=True, slots=True)
class UseNewKey(KeyEvent):
    """Sign with the new key; still accept the old one."""


@dataclass(frozen=True, slots=True)
class UseOldKey(KeyEvent):
    """Sign with the old key; still accept the new one."""


@dataclass(frozen=True, slots=True)
class KeySettled(KeyEvent):
    """The change has ended; only the key in use is accepted.

    If `changed`, the program stores `key` for its next run; else the old key stays and `key` is the one that
    was not accepted.
    """

    key: SigningKey | None
    changed: bool


def signed_with(packet: Packet, key: SigningKey | None, now: float) -> bool:
    """Return whether a packet is signed with the key, or unsigned if the key is None."""
    if key is None or not packet.signed:
        return key is None and not packet.signed
    return bool(Parser(common, signing=key.signing()).feed(packet.raw, time_if_set(now)))


class KeyChange:
    """The client's view of a key change: how the target signs, and whether that is final."""

    def __init__(self, peer: Address, new: SigningKey | None, emit: Callable[[Event], None]) -> None:
        self.new = new
        self.uses_new = False
        self._inconclusive = 0
        self.settled: bool | None = None
        self.requested_at: float | None = None
        self._peer = peer
        self._emit = emit
        emit(ListenForKey(peer, new))

    def observe(self, packet: Packet, now: float) -> None:
        """Handle a packet of the target."""
        is_new = signed_with(packet, self.new, now)
        if self._is_inconclusive(packet, is_new):
            return
        if is_new != self.uses_new:
            self.uses_new = is_new
            self._emit(UseNewKey(self._peer) if is_new else UseOldKey(self._peer))
        settled = self.requested_at is not None and now >= self.requested_at + SETTLED_AFTER
        if settled or (self.requested_at is None and is_new):
            self.settle()

    def _is_inconclusive(self, packet: Packet, is_new: bool) -> bool:
        """Return whether a packet proves nothing: no checksum covers a signature, so it may be damaged."""
        self._inconclusive = self._inconclusive + 1 if packet.signed and not is_new else 0
        return 0 < self._inconclusive < MIN_PROOF_PACKETS

    def settle(self) -> None:
        """Take the present way as final."""
        if self.settled is None:
            self.settled = self.uses_new
            self._emit(KeySettled(self._peer, self.new, self.settled))
