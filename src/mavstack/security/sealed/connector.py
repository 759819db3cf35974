"""The initiating side of handshakes with one peer.

An attempt is a hello, an initiate when the challenge comes, and ends with the respond; nothing is sent again
within an attempt. The next attempt begins after a second, later ones more slowly; the last eight stay open,
so that a slow link whose answers take several seconds succeeds too.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.security.sealed import messages
from mavstack.security.sealed.noise import HandshakeError, Initiator
from mavstack.security.sealed.session import EPOCHS, Session

if TYPE_CHECKING:
    from mavstack.security.sealed.config import SealConfig
    from mavstack.security.sealed.noise import Random

FIRST_INTERVAL: Final = 1.0
MAX_INTERVAL: Final = 3.0
_GROWTH: Final = 1.5
_MAX_ATTEMPTS: Final = 8


@dataclass(slots=True)
class _Attempt:
    epoch: int
    handshake: Initiator | None = None


class Connector:
    """Makes handshakes with one peer.

    Args:
        config: The keys and algorithms.
        random: Returns random bytes.

    Attributes:
        refusals: Refused messages by reason.
        unanswered: Attempts since the last session.
    """

    def __init__(self, config: SealConfig, random: Random) -> None:
        self._config = config
        self._random = random
        self._attempts: dict[bytes, _Attempt] = {}
        self._epoch = random(1)[0] % EPOCHS
        self._interval = FIRST_INTERVAL
        self.next_attempt = float("-inf")
        self.refusals: Counter[str] = Counter()
        self.unanswered = 0

    def begin(self, now: float) -> bytes:
        """Begin an attempt; return the hello. The next one is due at `next_attempt`."""
        nonce = self._random(messages.NONCE_SIZE)
        while len(self._attempts) >= _MAX_ATTEMPTS:
            del self._attempts[next(iter(self._attempts))]
        self._attempts[nonce] = _Attempt(self._epoch)
        self.unanswered += 1
        jitter = self._random(1)[0] / 1024
        self.next_attempt = now + self._interval * (1 + jitter)
        self._interval = min(self._interval * _GROWTH, MAX_INTERVAL)
        return messages.hello(self._config.suite, nonce)

    def cancel(self, now: float) -> None:
        """Give up all attempts, because the peer made a session."""
        self._attempts.clear()
        self._reset(now)

    def is_own(self, data: bytes) -> bool:
        """Return whether a message is one that this end has sent in an attempt."""
        kind = data[0] if data else 0
        hello = messages.read_hello(data) if kind == messages.HELLO else None
        initiate = messages.read_initiate(data) if kind == messages.INITIATE else None
        nonce = hello[1] if hello is not None else initiate.nonce if initiate is not None else None
        return nonce in self._attempts

    def challenge(self, data: bytes) -> bytes:
        """Answer a challenge by an initiate; empty if it belongs to no attempt."""
        challenge = messages.read_challenge(data)
        if challenge is None:
            return self._refuse("malformed")
        attempt = self._attempts.get(challenge.nonce)
        if attempt is None or attempt.handshake is not None:
            return self._refuse("no such attempt")
        config = self._config
        header = messages.initiate_header(config.suite, attempt.epoch, challenge)
        handshake = Initiator(config.suite, config.identity, messages.prologue(header), self._random)
        try:
            first = handshake.first_message()
        except HandshakeError:  # the configured key of the peer is not a valid public key
            return self._refuse("unusable key of the peer")
        attempt.handshake = handshake
        return header + first

    def respond(self, data: bytes, now: float) -> Session | None:
        """Finish a handshake; None if the message belongs to no attempt or is forged."""
        nonce, message = messages.read_respond(data)
        attempt = self._attempts.get(nonce)
        if attempt is None or attempt.handshake is None:
            self._refuse("no such attempt")
            return None
        try:
            keys = attempt.handshake.read_second(message)
        except HandshakeError:
            self._refuse("forged")
            return None
        self._attempts.clear()
        self._reset(now)
        self._epoch = (attempt.epoch + 1) % EPOCHS
        config = self._config
        peer = config.peers.get(config.identity.peer, "")
        return Session(config.suite, keys, attempt.epoch, initiator=True, now=now, peer=peer)

    def _reset(self, now: float) -> None:
        self._interval = FIRST_INTERVAL
        self.next_attempt = now + FIRST_INTERVAL
        self.unanswered = 0

    def _refuse(self, reason: str) -> bytes:
        self.refusals[reason] += 1
        return b""
