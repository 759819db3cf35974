"""Signing keys sent to another of our own stations, encrypted and signed with post-quantum algorithms.

SETUP_SIGNING carries a key in the clear. Between two of our own endpoints a key can be sent as a file
instead: encrypted for one recipient (ML-KEM-768, then ChaCha20-Poly1305), and signed by the sender
(ML-DSA-65), whom the recipient knows by a pinned public identity. The file may go over any channel, such as
FTP, mail or a memory card. A signature of 3309 bytes cannot protect single packets, whose signature has six;
it protects the transport of the key that does. The file has 4522 bytes:

    offset  bytes  content
    0       4      "MSKO"
    4       1      version, 1
    5       8      time of the offer, unsigned big-endian seconds since 1970
    13      32     SHA-256 of the sender's public identity
    45      32     SHA-256 of the recipient's public identity
    77      1088   ciphertext of ML-KEM-768
    1165    48     the key, encrypted with ChaCha20-Poly1305 (nonce of zeros: each shared secret is used once)
    1213    3309   ML-DSA-65 signature of everything before, with the context "mavstack key offer v1"

The key of ChaCha20-Poly1305 is HKDF-SHA256 of the shared secret with the first 77 bytes as info. These bytes
are also the associated data. A recipient refuses offers older than the newest one that it has accepted from
this sender, so that an old key does not come back; the caller keeps that time.

Nothing here has been reviewed by cryptographers; the algorithms and their implementation (OpenSSL, through
`cryptography`) have.
"""

from __future__ import annotations

import hashlib
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.errors import MissingExtraError, SigningError
from mavstack.security.keys import SigningKey

try:
    from cryptography.exceptions import InvalidSignature, InvalidTag
    from cryptography.hazmat.primitives.asymmetric import mldsa, mlkem
    from cryptography.hazmat.primitives.ciphers.aead import ChaCha20Poly1305
    from cryptography.hazmat.primitives.hashes import SHA256
    from cryptography.hazmat.primitives.kdf.hkdf import HKDF
except ImportError:
    raise MissingExtraError("key offers", "secure") from None

if TYPE_CHECKING:
    from typing import NoReturn, Self

MAGIC: Final = b"MSKO\x01"
_HEADER: Final = struct.Struct(">5sQ32s32s")
KEM_SIZE, SEALED_SIZE, SIGNATURE_SIZE = 1088, 48, 3309
OFFER_SIZE: Final = _HEADER.size + KEM_SIZE + SEALED_SIZE + SIGNATURE_SIZE
PUBLIC_SIZE: Final = 1952 + 1184
SECRET_SIZE: Final = 32 + 64
#: Maximum seconds by which the sender's clock may be ahead of the receiver's.
MAX_CLOCK_LEAD: Final = 300
_CONTEXT: Final = b"mavstack key offer v1"
_NONCE: Final = bytes(12)
_MLDSA_PUBLIC, _MLDSA_SEED = 1952, 32


@dataclass(frozen=True, slots=True)
class PublicIdentity:
    """The public keys of a station: what others pin.

    Attributes:
        data: The ML-DSA-65 public key, then the ML-KEM-768 public key.
    """

    data: bytes

    def __post_init__(self) -> None:
        """Check the length."""
        if len(self.data) != PUBLIC_SIZE:
            raise SigningError(f"a public identity must have {PUBLIC_SIZE} bytes, got {len(self.data)}")

    @property
    def fingerprint(self) -> str:
        """64 hexadecimal digits that two people compare."""
        return hashlib.sha256(self.data).hexdigest()


class Identity:
    """The secret keys of a station, which never appear in a `repr`, an error or a pickle.

    Args:
        secret: The seed of ML-DSA-65, then that of ML-KEM-768.

    Raises:
        SigningError: The secret does not have 96 bytes.
    """

    __slots__ = ("_kem", "_secret", "_signer")

    def __init__(self, secret: bytes) -> None:
        if len(secret) != SECRET_SIZE:
            raise SigningError(f"an identity must have {SECRET_SIZE} bytes, got {len(secret)}")
        self._secret = bytes(secret)
        self._signer = mldsa.MLDSA65PrivateKey.from_seed_bytes(self._secret[:_MLDSA_SEED])
        self._kem = mlkem.MLKEM768PrivateKey.from_seed_bytes(self._secret[_MLDSA_SEED:])

    @classmethod
    def generate(cls) -> Self:
        """Make a new identity.

        Returns:
            The identity.
        """
        signer, kem = mldsa.MLDSA65PrivateKey.generate(), mlkem.MLKEM768PrivateKey.generate()
        return cls(signer.private_bytes_raw() + kem.private_bytes_raw())

    @property
    def public(self) -> PublicIdentity:
        """The public identity, for other stations."""
        keys = (self._signer.public_key(), self._kem.public_key())
        return PublicIdentity(b"".join(key.public_bytes_raw() for key in keys))

    def secret_bytes(self) -> bytes:
        """Return the 96 bytes of the identity, to store them.

        Returns:
            The secret.
        """
        return self._secret

    def offer(self, key: SigningKey, recipient: PublicIdentity, now: float) -> bytes:
        """Encrypt a signing key for a recipient, and sign it.

        Args:
            key: The signing key.
            recipient: The public identity of the recipient.
            now: Unix time in seconds.

        Returns:
            The offer.
        """
        header = _HEADER.pack(MAGIC, int(now), *map(_digest, (self.public, recipient)))
        public = mlkem.MLKEM768PublicKey.from_public_bytes(recipient.data[_MLDSA_PUBLIC:])
        shared, encapsulated = public.encapsulate()
        sealed = _cipher(shared, header).encrypt(_NONCE, key.secret_bytes(), header)
        signed = header + encapsulated + sealed
        return signed + self._signer.sign(signed, _CONTEXT)

    def accept(
        self, offer: bytes, sender: PublicIdentity, now: float, *, newest: int = 0
    ) -> tuple[SigningKey, int]:
        """Verify an offer and decrypt its key.

        Args:
            offer: The offer.
            sender: The pinned public identity of the sender.
            now: Unix time in seconds.
            newest: The time of the newest offer that was accepted from this sender; 0: none.

        Returns:
            The key, and the time of the offer, to be passed as `newest` next time.

        Raises:
            SigningError: The offer is malformed, forged, for someone else, or not newer than `newest`.
        """
        if len(offer) != OFFER_SIZE or not offer.startswith(MAGIC):
            _refuse("it is no key offer")
        signed, signature = offer[:-SIGNATURE_SIZE], offer[-SIGNATURE_SIZE:]
        header, sealed = signed[: _HEADER.size], signed[-SEALED_SIZE:]
        _, time, by, to = _HEADER.unpack(header)
        if by != _digest(sender):
            _refuse("another station signed it")
        try:
            public = mldsa.MLDSA65PublicKey.from_public_bytes(sender.data[:_MLDSA_PUBLIC])
            public.verify(signature, signed, _CONTEXT)
        except (InvalidSignature, ValueError):
            _refuse("its signature is wrong")
        if to != _digest(self.public):
            _refuse("it is for another station")
        if time <= newest:
            _refuse("it is not newer than the last one from this station")
        if time > now + MAX_CLOCK_LEAD:
            _refuse("it was made in the future: check both clocks")
        try:
            shared = self._kem.decapsulate(signed[_HEADER.size : -SEALED_SIZE])
            return SigningKey(_cipher(shared, header).decrypt(_NONCE, sealed, header)), time
        except (InvalidTag, ValueError):
            _refuse("its key cannot be decrypted")

    def __repr__(self) -> str:
        return "Identity(…)"

    def __reduce__(self) -> NoReturn:
        raise SigningError("identities cannot be pickled")


def _cipher(shared: bytes, header: bytes) -> ChaCha20Poly1305:
    return ChaCha20Poly1305(HKDF(SHA256(), 32, salt=None, info=header).derive(shared))


def _digest(identity: PublicIdentity) -> bytes:
    return hashlib.sha256(identity.data).digest()


def _refuse(reason: str) -> NoReturn:
    raise SigningError(f"accepting the key offer failed: {reason}")
