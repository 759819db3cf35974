"""Signing keys: 32 secret bytes that never show in a text.

A key from a passphrase is its SHA-256, as ground stations make it. A key file holds the key in hexadecimal
and is readable by its owner only.
"""

from __future__ import annotations

import hashlib
import hmac
import os
import secrets
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from mavstack.errors import SigningError
from mavstack.wire import Signing

if TYPE_CHECKING:
    from typing import Self

KEY_LENGTH = 32


class SigningKey:
    """A signing key; its `repr` and error texts never hold it."""

    __slots__ = ("_secret",)

    def __init__(self, secret: bytes) -> None:
        if len(secret) != KEY_LENGTH:
            raise SigningError(f"a signing key has {KEY_LENGTH} bytes, not {len(secret)}")
        self._secret = bytes(secret)

    @classmethod
    def generate(cls) -> Self:
        """Make a new random key."""
        return cls(secrets.token_bytes(KEY_LENGTH))

    @classmethod
    def from_passphrase(cls, passphrase: str) -> Self:
        """Make the key that ground stations make of `passphrase`: its SHA-256."""
        return cls(hashlib.sha256(passphrase.encode()).digest())

    @classmethod
    def from_hex(cls, text: str) -> Self:
        """Read a key written as 64 hexadecimal digits."""
        try:
            secret = bytes.fromhex(text)
        except ValueError:
            raise SigningError("a signing key is written as 64 hexadecimal digits") from None
        return cls(secret)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a key file."""
        try:
            text = Path(path).read_text("ascii")
        except (OSError, UnicodeDecodeError) as error:
            raise SigningError(f"{path}: cannot be read as a key file ({type(error).__name__})") from None
        try:
            return cls.from_hex(text.strip())
        except SigningError as error:
            raise SigningError(f"{path}: {error}") from None

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a key file that only its owner can read; an existing file is never overwritten."""
        try:
            descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        except OSError as error:
            raise SigningError(f"{path}: {error.strerror or error}") from None
        with os.fdopen(descriptor, "w", encoding="ascii") as file:
            file.write(self._secret.hex() + "\n")

    def secret_bytes(self) -> bytes:
        """The key itself, for SETUP_SIGNING."""
        return self._secret

    def signing(self, link_id: int = 0, **policy: Any) -> Signing:  # noqa: ANN401 (Signing's own keywords)
        """Make the signing state of one link; `policy` as for `mavstack.Signing`."""
        return Signing(self._secret, link_id, **policy)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, SigningKey):
            return NotImplemented
        return hmac.compare_digest(self._secret, other._secret)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return "SigningKey(…)"

    def __reduce__(self) -> NoReturn:
        raise SigningError("signing keys are not pickled; save them to a key file")
