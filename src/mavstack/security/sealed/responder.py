"""The answering side of handshakes, one for all peers of a link: stateless until a peer proves its key."""

from __future__ import annotations

from collections import Counter, OrderedDict
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.security.sealed import messages
from mavstack.security.sealed.messages import CookieJar
from mavstack.security.sealed.noise import Answer, HandshakeError, respond
from mavstack.security.sealed.session import EPOCHS, Session

if TYPE_CHECKING:
    from mavstack.security.sealed.config import SealConfig
    from mavstack.security.sealed.noise import Random

#: Maximum number of handshakes of all hosts per second, and at once after a pause.
HANDSHAKE_RATE: Final = 100.0
HANDSHAKE_BURST: Final = 200.0
#: The same limits for one host, so that it does not use up the handshakes of other hosts.
HOST_RATE: Final = 4.0
HOST_BURST: Final = 16.0
_MAX_HOSTS: Final = 1024
#: Maximum number of kept answers, which are sent again for a duplicate of an initiate message.
_MAX_ANSWERS: Final = 64


class _Allowance:
    """A number of handshakes that grows with time up to a limit."""

    __slots__ = ("_burst", "_left", "_rate", "_updated")

    def __init__(self, rate: float, burst: float) -> None:
        self._rate = rate
        self._burst = self._left = burst
        self._updated = 0.0

    def take(self, now: float) -> bool:
        elapsed, self._updated = max(0.0, now - self._updated), now
        self._left = min(self._burst, self._left + elapsed * self._rate)
        if self._left < 1:
            return False
        self._left -= 1
        return True


class Reply(NamedTuple):
    """The result of a handshake message: the bytes to send, and the session that a peer has proved."""

    data: bytes = b""
    session: Session | None = None


class Responder:
    """Answers handshakes.

    Args:
        config: The keys and algorithms.
        random: Returns random bytes.

    Attributes:
        refusals: Refused messages by reason.
    """

    def __init__(self, config: SealConfig, random: Random) -> None:
        self._config = config
        self._random = random
        self._cookies = CookieJar(random)
        self._answers: OrderedDict[bytes, bytes] = OrderedDict()
        self._allowance = _Allowance(HANDSHAKE_RATE, HANDSHAKE_BURST)
        self._hosts: OrderedDict[bytes, _Allowance] = OrderedDict()
        self.refusals: Counter[str] = Counter()

    def hello(self, data: bytes, address: bytes, now: float) -> Reply:
        """Answer a hello by a challenge."""
        hello = messages.read_hello(data)
        if hello is None:
            return self._refuse("malformed")
        suite, nonce = hello
        if suite != self._config.suite.number:
            return self._refuse("other algorithms")
        return Reply(messages.challenge(nonce, self._cookies.make(address, nonce, now)))

    def initiate(self, data: bytes, address: bytes, now: float) -> Reply:
        """Answer an initiate by a respond."""
        initiate = messages.read_initiate(data)
        if initiate is None or initiate.epoch >= EPOCHS:
            return self._refuse("malformed")
        if initiate.suite != self._config.suite.number:
            return self._refuse("other algorithms")
        if not self._cookies.verify(initiate.cookie, address, initiate.nonce, now):
            return self._refuse("wrong cookie")
        if data in self._answers:  # a duplicate of an initiate message
            return Reply(self._answers[data])
        if not (self._allowance_of(address).take(now) and self._allowance.take(now)):
            return self._refuse("too many handshakes")
        return self._answer(data, initiate, now)

    def _answer(self, data: bytes, initiate: messages.Initiate, now: float) -> Reply:
        config = self._config
        try:
            answer = respond(
                config.suite,
                config.identity,
                messages.prologue(initiate.header),
                initiate.message,
                is_known=config.peers.__contains__,
                random=self._random,
            )
        except HandshakeError:
            return self._refuse("forged or unknown key")
        reply = messages.respond(initiate.nonce, answer.message)
        self._answers[data] = reply
        if len(self._answers) > _MAX_ANSWERS:
            self._answers.popitem(last=False)
        return Reply(reply, self._session(answer, initiate.epoch, now))

    def _session(self, answer: Answer, epoch: int, now: float) -> Session:
        keys = answer.sending, answer.receiving
        peer = self._config.peers.get(answer.public_key, "")
        return Session(self._config.suite, keys, epoch, initiator=False, now=now, peer=peer)

    def _allowance_of(self, address: bytes) -> _Allowance:
        """Return the allowance of a host; the hosts that asked last are kept."""
        host = address.rpartition(b":")[0]
        allowance = self._hosts.pop(host, None) or _Allowance(HOST_RATE, HOST_BURST)
        self._hosts[host] = allowance
        if len(self._hosts) > _MAX_HOSTS:
            self._hosts.popitem(last=False)
        return allowance

    def _refuse(self, reason: str) -> Reply:
        self.refusals[reason] += 1
        return Reply()
