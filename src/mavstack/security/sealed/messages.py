"""The handshake messages of sealed links around those of Noise, and the cookies that protect the responder.

    hello      01 version suite nonce(8) zeros(14)
    challenge  02 nonce(8) cookie(16)
    initiate   03 version suite epoch nonce(8) cookie(16) first Noise message
    respond    04 nonce(8) second Noise message
    unknown    05 header(4) of a frame of no session

A hello costs the responder one hash and no memory, and its answer is not larger. The cookie proves that the
initiator receives at its address, and that an initiate is not older than two minutes: header and cookie are
the prologue of the Noise handshake, so an old initiate cannot be sent again with a new cookie.
"""

from __future__ import annotations

import hmac
from hashlib import sha256
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from mavstack.security.sealed.noise import Random, Suite

VERSION: Final = 1
HELLO, CHALLENGE, INITIATE, RESPOND, UNKNOWN = range(1, 6)
NONCE_SIZE: Final = 8
COOKIE_SIZE: Final = 16
HELLO_SIZE: Final = 1 + NONCE_SIZE + COOKIE_SIZE
INITIATE_HEADER: Final = 4 + NONCE_SIZE + COOKIE_SIZE
UNKNOWN_SIZE: Final = 5
#: Seconds for which a secret signs new cookies; these cookies are valid for the same time after it.
COOKIE_LIFETIME: Final = 60.0
_PROLOGUE: Final = b"mavstack sealed link"


class Challenge(NamedTuple):
    """The answer to a hello."""

    nonce: bytes
    cookie: bytes


class Initiate(NamedTuple):
    """An initiate: `header` are the bytes in front of the Noise message."""

    suite: int
    epoch: int
    nonce: bytes
    cookie: bytes
    header: bytes
    message: bytes


def hello(suite: Suite, nonce: bytes) -> bytes:
    """Return a hello."""
    return bytes((HELLO, VERSION, suite.number)) + nonce + bytes(HELLO_SIZE - 3 - NONCE_SIZE)


def read_hello(data: bytes) -> tuple[int, bytes] | None:
    """Return suite and nonce of a hello; None if it is malformed or of another version."""
    if len(data) != HELLO_SIZE or data[1] != VERSION:
        return None
    return data[2], data[3 : 3 + NONCE_SIZE]


def challenge(nonce: bytes, cookie: bytes) -> bytes:
    """Return a challenge."""
    return bytes((CHALLENGE,)) + nonce + cookie


def read_challenge(data: bytes) -> Challenge | None:
    """Return the content of a challenge; None if it is malformed."""
    if len(data) != 1 + NONCE_SIZE + COOKIE_SIZE:
        return None
    return Challenge(data[1 : 1 + NONCE_SIZE], data[1 + NONCE_SIZE :])


def initiate_header(suite: Suite, epoch: int, answer: Challenge) -> bytes:
    """Return an initiate up to its Noise message."""
    return bytes((INITIATE, VERSION, suite.number, epoch)) + answer.nonce + answer.cookie


def read_initiate(data: bytes) -> Initiate | None:
    """Return the content of an initiate; None if it is malformed or of another version."""
    if len(data) <= INITIATE_HEADER or data[1] != VERSION:
        return None
    nonce, cookie = data[4 : 4 + NONCE_SIZE], data[4 + NONCE_SIZE : INITIATE_HEADER]
    return Initiate(data[2], data[3], nonce, cookie, data[:INITIATE_HEADER], data[INITIATE_HEADER:])


def respond(nonce: bytes, message: bytes) -> bytes:
    """Return a respond."""
    return bytes((RESPOND,)) + nonce + message


def read_respond(data: bytes) -> tuple[bytes, bytes]:
    """Return nonce and Noise message of a respond."""
    return data[1 : 1 + NONCE_SIZE], data[1 + NONCE_SIZE :]


def prologue(header: bytes) -> bytes:
    """Return the prologue of the Noise handshake."""
    return _PROLOGUE + header


class CookieJar:
    """Makes and verifies the cookies of one responder, by secrets that change every minute."""

    def __init__(self, random: Random) -> None:
        self._random = random
        self._current, self._previous = random(32), b""
        self._changes_at: float | None = None

    def make(self, address: bytes, nonce: bytes, now: float) -> bytes:
        """Return the cookie of an address and a nonce."""
        self._change(now)
        return _cookie(self._current, address, nonce)

    def verify(self, cookie: bytes, address: bytes, nonce: bytes, now: float) -> bool:
        """Return whether a cookie is right and not too old."""
        self._change(now)
        secrets = filter(None, (self._current, self._previous))
        return any(hmac.compare_digest(cookie, _cookie(secret, address, nonce)) for secret in secrets)

    def _change(self, now: float) -> None:
        if self._changes_at is None:
            self._changes_at = now + COOKIE_LIFETIME
        elif now >= self._changes_at:
            is_recent = now < self._changes_at + COOKIE_LIFETIME
            self._previous = self._current if is_recent else b""
            self._current = self._random(32)
            self._changes_at = now + COOKIE_LIFETIME


def _cookie(secret: bytes, address: bytes, nonce: bytes) -> bytes:
    return hmac.digest(secret, nonce + address, sha256)[:COOKIE_SIZE]
