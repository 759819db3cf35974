"""The Noise handshakes of sealed links: `NNpsk0` for a pre-shared key, `IK` for pinned public keys.

The messages are those of the Noise Protocol Framework, revision 34, with X25519, SHA-256 and ChaChaPoly or
AESGCM. A hybrid handshake adds ML-KEM-768 by the tokens `e1` and `ekem1` of the framework's extension for
hybrid forward secrecy: the session is safe as long as one of the two exchanges is.

    NNpsk0:  -> psk, e            IK:  <- s
             <- e, ee                  -> e, es, s, ss
                                       <- e, ee, se
"""

from __future__ import annotations

import hmac
from copy import copy
from dataclasses import dataclass
from hashlib import sha256
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.errors import MissingExtraError

try:
    from cryptography.exceptions import InvalidTag
    from cryptography.hazmat.primitives.asymmetric.mlkem import MLKEM768PrivateKey, MLKEM768PublicKey
    from cryptography.hazmat.primitives.asymmetric.x25519 import X25519PrivateKey, X25519PublicKey
    from cryptography.hazmat.primitives.ciphers.aead import AESGCM, ChaCha20Poly1305
except ImportError as missing:
    raise MissingExtraError("a sealed link", "secure") from missing

if TYPE_CHECKING:
    from collections.abc import Callable

Random: TypeAlias = "Callable[[int], bytes]"
Cipher: TypeAlias = AESGCM | ChaCha20Poly1305

KEY_SIZE: Final = 32
TAG_SIZE: Final = 16
KEM_PUBLIC_SIZE: Final = 1184
KEM_CIPHERTEXT_SIZE: Final = 1088
_KEM_SEED_SIZE: Final = 64
_HASH_SIZE: Final = 32


class HandshakeError(Exception):
    """A handshake message that is malformed, forged, or from an unknown key."""


@dataclass(frozen=True, slots=True)
class Suite:
    """The algorithms of a handshake; both ends are configured with one and accept no other.

    Attributes:
        pinned: True for pinned public keys (IK), false for a pre-shared key (NNpsk0).
        hybrid: True to add ML-KEM-768.
        aes: True for AES-256-GCM, false for ChaCha20-Poly1305.
    """

    pinned: bool = False
    hybrid: bool = False
    aes: bool = False

    @property
    def number(self) -> int:
        """The suite on the wire: bit 0 pinned, bit 1 hybrid, bit 2 AES."""
        return self.pinned | self.hybrid << 1 | self.aes << 2

    @property
    def name(self) -> bytes:
        """The protocol name of the Noise framework."""
        pattern = (
            ("IKhfs" if self.hybrid else "IK") if self.pinned else "NNpsk0+hfs" if self.hybrid else "NNpsk0"
        )
        exchange = "25519+MLKEM768" if self.hybrid else "25519"
        return f"Noise_{pattern}_{exchange}_{'AESGCM' if self.aes else 'ChaChaPoly'}_SHA256".encode()

    @property
    def first_size(self) -> int:
        """The size of the first message, without payload."""
        size = KEY_SIZE + TAG_SIZE + (KEY_SIZE + TAG_SIZE) * self.pinned
        return size + self.hybrid * (KEM_PUBLIC_SIZE + TAG_SIZE * (not self.pinned))

    @property
    def second_size(self) -> int:
        """The size of the second message, without payload."""
        return KEY_SIZE + TAG_SIZE + self.hybrid * (KEM_CIPHERTEXT_SIZE + TAG_SIZE)

    def cipher(self, key: bytes) -> Cipher:
        """Return the cipher of the suite with a key."""
        return AESGCM(key) if self.aes else ChaCha20Poly1305(key)

    def nonce(self, counter: int) -> bytes:
        """Return the nonce of a counter: 4 zero bytes and 8 bytes, little-endian, for AES big-endian."""
        return b"\0\0\0\0" + counter.to_bytes(8, "big" if self.aes else "little")


@dataclass(frozen=True, slots=True)
class Identity:
    """The keys of one end of a handshake.

    Attributes:
        shared_key: The pre-shared key; empty with pinned keys.
        private_key: The own X25519 key; empty with a pre-shared key.
        peer: The public key of the responder, which an initiator must know; empty at a responder.
    """

    shared_key: bytes = b""
    private_key: bytes = b""
    peer: bytes = b""

    def __repr__(self) -> str:
        return "Identity(…)"


class _State:
    """The symmetric state of a handshake."""

    def __init__(self, suite: Suite, prologue: bytes) -> None:
        self._suite = suite
        name = suite.name
        self.hash = name.ljust(_HASH_SIZE, b"\0") if len(name) <= _HASH_SIZE else sha256(name).digest()
        self.chain = self.hash
        self._key = b""
        self._counter = 0
        self.mix_hash(prologue)

    def mix_hash(self, data: bytes) -> None:
        self.hash = sha256(self.hash + data).digest()

    def mix_key(self, secret: bytes) -> None:
        self.chain, self._key = derive(self.chain, secret, 2)
        self._counter = 0

    def mix_key_and_hash(self, secret: bytes) -> None:
        self.chain, mixed, self._key = derive(self.chain, secret, 3)
        self.mix_hash(mixed)
        self._counter = 0

    def encrypt(self, plain: bytes) -> bytes:
        sealed = plain
        if self._key:
            nonce = self._suite.nonce(self._counter)
            sealed = self._suite.cipher(self._key).encrypt(nonce, plain, self.hash)
            self._counter += 1
        self.mix_hash(sealed)
        return sealed

    def decrypt(self, sealed: bytes) -> bytes:
        plain = sealed
        if self._key:
            nonce = self._suite.nonce(self._counter)
            try:
                plain = self._suite.cipher(self._key).decrypt(nonce, sealed, self.hash)
            except InvalidTag:
                raise HandshakeError from None
            self._counter += 1
        self.mix_hash(sealed)
        return plain

    def sealed_size(self, size: int) -> int:
        return size + (TAG_SIZE if self._key else 0)


class Initiator:
    """The initiating end of one handshake.

    Args:
        suite: The algorithms.
        identity: The own keys.
        prologue: Bytes on which both ends agree.
        random: Returns random bytes.
    """

    def __init__(self, suite: Suite, identity: Identity, prologue: bytes, random: Random) -> None:
        self._suite, self._identity = suite, identity
        self._state = _State(suite, prologue)
        self._ephemeral = X25519PrivateKey.from_private_bytes(random(KEY_SIZE))
        self._kem = MLKEM768PrivateKey.from_seed_bytes(random(_KEM_SEED_SIZE)) if suite.hybrid else None

    def first_message(self) -> bytes:
        """Return the first message."""
        state, identity = self._state, self._identity
        if self._suite.pinned:
            state.mix_hash(identity.peer)
        else:
            state.mix_key_and_hash(identity.shared_key)
        public = self._ephemeral.public_key().public_bytes_raw()
        _mix_ephemeral(self._suite, state, public)
        message = public
        if self._kem is not None:
            message += state.encrypt(self._kem.public_key().public_bytes_raw())
        if self._suite.pinned:
            static = X25519PrivateKey.from_private_bytes(identity.private_key)
            state.mix_key(exchange(self._ephemeral, identity.peer))
            message += state.encrypt(static.public_key().public_bytes_raw())
            state.mix_key(exchange(static, identity.peer))
        return message + state.encrypt(b"")

    def read_second(self, message: bytes) -> tuple[bytes, bytes]:
        """Read the second message; return the keys for sending and receiving.

        A forged message changes nothing: the right one can still be read.

        Raises:
            HandshakeError: The message is malformed or forged.
        """
        if len(message) != self._suite.second_size:
            raise HandshakeError
        state = copy(self._state)
        public, position = message[:KEY_SIZE], KEY_SIZE
        _mix_ephemeral(self._suite, state, public)
        state.mix_key(exchange(self._ephemeral, public))
        if self._kem is not None:
            end = position + state.sealed_size(KEM_CIPHERTEXT_SIZE)
            state.mix_key(self._kem.decapsulate(state.decrypt(message[position:end])))
            position = end
        if self._suite.pinned:
            state.mix_key(exchange(X25519PrivateKey.from_private_bytes(self._identity.private_key), public))
        state.decrypt(message[position:])
        sending, receiving = derive(state.chain, b"", 2)
        return sending, receiving


@dataclass(frozen=True, slots=True)
class Answer:
    """The answer to a first message, and the keys of the session.

    Attributes:
        message: The second message.
        sending: The key for frames to the initiator.
        receiving: The key for frames from the initiator.
        public_key: The public key of the initiator; empty with a pre-shared key.
    """

    message: bytes
    sending: bytes
    receiving: bytes
    public_key: bytes

    def __repr__(self) -> str:
        return "Answer(…)"


def respond(
    suite: Suite,
    identity: Identity,
    prologue: bytes,
    first: bytes,
    *,
    is_known: Callable[[bytes], bool],
    random: Random,
) -> Answer:
    """Answer the first message of a handshake.

    Args:
        suite: The algorithms.
        identity: The own keys.
        prologue: Bytes on which both ends agree.
        first: The first message.
        is_known: Returns whether a public key may connect; not called with a pre-shared key.
        random: Returns random bytes.

    Returns:
        The answer and the keys of the session.

    Raises:
        HandshakeError: The message is malformed, forged, or from an unknown key.
    """
    if len(first) != suite.first_size:
        raise HandshakeError
    state = _State(suite, prologue)
    static = X25519PrivateKey.from_private_bytes(identity.private_key) if suite.pinned else None
    if static is not None:
        state.mix_hash(static.public_key().public_bytes_raw())
    else:
        state.mix_key_and_hash(identity.shared_key)
    theirs, position = first[:KEY_SIZE], KEY_SIZE
    _mix_ephemeral(suite, state, theirs)
    kem = b""
    if suite.hybrid:
        end = position + state.sealed_size(KEM_PUBLIC_SIZE)
        kem, position = state.decrypt(first[position:end]), end
    public_key = b""
    if static is not None:
        state.mix_key(exchange(static, theirs))
        end = position + KEY_SIZE + TAG_SIZE
        public_key, position = state.decrypt(first[position:end]), end
        if not is_known(public_key):
            raise HandshakeError
        state.mix_key(exchange(static, public_key))
    state.decrypt(first[position:])
    return _second_message(suite, state, theirs, (kem, public_key), random)


def _second_message(
    suite: Suite, state: _State, theirs: bytes, keys: tuple[bytes, bytes], random: Random
) -> Answer:
    kem, public_key = keys
    ephemeral = X25519PrivateKey.from_private_bytes(random(KEY_SIZE))
    message = ephemeral.public_key().public_bytes_raw()
    _mix_ephemeral(suite, state, message)
    state.mix_key(exchange(ephemeral, theirs))
    if suite.hybrid:
        try:
            secret, ciphertext = MLKEM768PublicKey.from_public_bytes(kem).encapsulate()
        except ValueError:
            raise HandshakeError from None
        message += state.encrypt(ciphertext)
        state.mix_key(secret)
    if suite.pinned:
        state.mix_key(exchange(ephemeral, public_key))
    message += state.encrypt(b"")
    receiving, sending = derive(state.chain, b"", 2)
    return Answer(message, sending, receiving, public_key)


def _mix_ephemeral(suite: Suite, state: _State, public: bytes) -> None:
    state.mix_hash(public)
    if not suite.pinned:  # with a pre-shared key, Noise also mixes the ephemeral public key into the key
        state.mix_key(public)


def exchange(own: X25519PrivateKey, public: bytes) -> bytes:
    """Return the shared secret of X25519; raises `HandshakeError` for a point of low order."""
    try:
        return own.exchange(X25519PublicKey.from_public_bytes(public))
    except ValueError:
        raise HandshakeError from None


def public_of(private_key: bytes) -> bytes:
    """Return the public key of a private key."""
    return X25519PrivateKey.from_private_bytes(private_key).public_key().public_bytes_raw()


def derive(chain: bytes, secret: bytes, count: int) -> list[bytes]:
    """Return the outputs of Noise's HKDF with SHA-256."""
    extracted = hmac.digest(chain, secret, sha256)
    outputs: list[bytes] = []
    for number in range(1, count + 1):
        previous = outputs[-1] if outputs else b""
        outputs.append(hmac.digest(extracted, previous + bytes((number,)), sha256))
    return outputs
