"""The configuration of one end of a sealed link."""

from __future__ import annotations

import hmac
from dataclasses import dataclass, field
from hashlib import sha256
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.security.sealed.noise import KEY_SIZE, Identity, Suite

if TYPE_CHECKING:
    from collections.abc import Mapping

_SHARED_KEY_LABEL: Final = b"mavstack sealed link, pre-shared key"


@dataclass(frozen=True, slots=True)
class SealConfig:
    """The keys and algorithms of one end; both ends must have the same algorithms.

    Attributes:
        identity: The own keys; `peer` is the public key to connect to.
        suite: The algorithms.
        peers: The names of the public keys that may connect; empty with a pre-shared key.
    """

    identity: Identity = field(repr=False)
    suite: Suite
    peers: Mapping[bytes, str] = field(default_factory=dict)

    @classmethod
    def shared(cls, secret: bytes, *, hybrid: bool = False, aes: bool = False) -> SealConfig:
        """Create the configuration for a secret that both ends have.

        Args:
            secret: The 32 bytes of the secret, which may be a signing key: another key is derived from it.
            hybrid: True to add ML-KEM-768.
            aes: True for AES-256-GCM instead of ChaCha20-Poly1305.

        Returns:
            The configuration.

        Raises:
            InvalidArgumentError: The secret does not have 32 bytes.
        """
        if len(secret) != KEY_SIZE:
            raise InvalidArgumentError(f"a shared key must have {KEY_SIZE} bytes, got {len(secret)}")
        key = hmac.digest(secret, _SHARED_KEY_LABEL, sha256)
        return cls(Identity(shared_key=key), Suite(hybrid=hybrid, aes=aes))

    @classmethod
    def pinned(
        cls, private_key: bytes, peers: Mapping[bytes, str], *, hybrid: bool = False, aes: bool = False
    ) -> SealConfig:
        """Create the configuration for public keys that are known to each other.

        Args:
            private_key: The own X25519 key.
            peers: The public keys of the peers, and their names; an end that connects has one.
            hybrid: True to add ML-KEM-768.
            aes: True for AES-256-GCM instead of ChaCha20-Poly1305.

        Returns:
            The configuration.

        Raises:
            InvalidArgumentError: A key does not have 32 bytes, or there is no peer.
        """
        if not peers or any(len(key) != KEY_SIZE for key in (private_key, *peers)):
            raise InvalidArgumentError(f"a sealed link needs keys of {KEY_SIZE} bytes, and one peer or more")
        peer = next(iter(peers)) if len(peers) == 1 else b""
        return cls(Identity(private_key=private_key, peer=peer), Suite(True, hybrid, aes), dict(peers))

    @property
    def can_connect(self) -> bool:
        """True if it is clear to whom an end that connects speaks."""
        return not self.suite.pinned or bool(self.identity.peer)
