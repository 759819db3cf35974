"""Signing keys: 32 secret bytes that are never shown.

The key of a passphrase is its SHA-256, as in ground stations. A key file contains the key in hexadecimal and
is readable by its owner only; one that others can read is used, with a warning in the log.
"""

from __future__ import annotations

import hashlib
import hmac
import logging
import os
import secrets
import stat
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from mavstack.bounded_file import read_file_bounded
from mavstack.errors import SigningError
from mavstack.wire import Signing

if TYPE_CHECKING:
    from typing import Self

logger = logging.getLogger("mavstack.security")

KEY_LENGTH = 32
#: Maximum size of a key file in bytes.
MAX_FILE_BYTES = 4096


class SigningKey:
    """A signing key of 32 bytes, which never appears in a `repr`, an error or a pickle.

    Args:
        secret: The 32 bytes of the key.

    Raises:
        SigningError: The key does not have 32 bytes.
    """

    __slots__ = ("_secret",)

    def __init__(self, secret: bytes) -> None:
        if len(secret) != KEY_LENGTH:
            raise SigningError(f"a signing key must have {KEY_LENGTH} bytes, got {len(secret)}")
        self._secret = bytes(secret)

    @classmethod
    def generate(cls) -> Self:
        """Create a random key from the operating system's source of randomness.

        Returns:
            The new key.
        """
        return cls(secrets.token_bytes(KEY_LENGTH))

    @classmethod
    def from_passphrase(cls, passphrase: str) -> Self:
        """Derive the key of a passphrase, which is its SHA-256, as in ground stations.

        Args:
            passphrase: The passphrase; it is encoded as UTF-8.

        Returns:
            The key.
        """
        return cls(hashlib.sha256(passphrase.encode()).digest())

    @classmethod
    def from_hex(cls, text: str) -> Self:
        """Read a key from 64 hexadecimal digits.

        Args:
            text: The digits.

        Returns:
            The key.

        Raises:
            SigningError: The text is not 64 hexadecimal digits.
        """
        try:
            secret = bytes.fromhex(text)
        except ValueError:
            raise SigningError("a signing key must be 64 hexadecimal digits") from None
        return cls(secret)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a key file.

        Args:
            path: Path of the file.

        Returns:
            The key.

        Raises:
            SigningError: The file cannot be read, or contains no key.
        """
        try:
            text = read_file_bounded(path, MAX_FILE_BYTES).decode("ascii")
        except (OSError, UnicodeDecodeError) as error:
            raise SigningError(f"cannot read the key file {path}: {type(error).__name__}") from None
        try:
            key = cls.from_hex(text.strip())
        except SigningError as error:
            raise SigningError(f"cannot read the key file {path}: {error}") from None
        _warn_if_exposed(path)
        return key

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a key file that only its owner can read.

        Args:
            path: Path of the new file; an existing file is never overwritten.

        Raises:
            SigningError: The file exists or cannot be written.
        """
        try:
            descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        except OSError as error:
            raise SigningError(f"cannot write the key file {path}: {error.strerror or error}") from None
        try:
            with os.fdopen(descriptor, "w", encoding="ascii") as file:
                file.write(self._secret.hex() + "\n")
                file.flush()
                # write it to the disk itself: a vehicle with this key cannot be used if the file is lost
                os.fsync(descriptor)
        except OSError as error:
            Path(path).unlink(missing_ok=True)
            raise SigningError(f"cannot write the key file {path}: {error.strerror or error}") from None

    @property
    def fingerprint(self) -> str:
        """16 hexadecimal digits that tell keys apart, from which the key cannot be calculated."""
        return hmac.digest(self._secret, b"mavstack signing streams", hashlib.sha256)[:8].hex()

    def secret_bytes(self) -> bytes:
        """Return the 32 bytes of the key, for SETUP_SIGNING.

        Returns:
            The secret; do not log or store it.
        """
        return self._secret

    def signing(self, link_id: int = 0, **policy: Any) -> Signing:  # noqa: ANN401 (the keywords of Signing)
        """Create the signing state of one link.

        Args:
            link_id: Id of the link in signatures, 0 to 255.
            policy: Keyword arguments of `mavstack.Signing`.

        Returns:
            The signing state, for the parser and the encoder of the link.

        Raises:
            SigningError: The timestamp is out of range.
        """
        return Signing(self._secret, link_id, **policy)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, SigningKey):
            return NotImplemented
        return hmac.compare_digest(self._secret, other._secret)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return "SigningKey(…)"

    def __reduce__(self) -> NoReturn:
        raise SigningError("signing keys cannot be pickled: save them to a key file")


def _warn_if_exposed(path: str | os.PathLike[str]) -> None:
    """Warn if others than its owner can read or replace a key file; Windows has no such permissions."""
    if sys.platform == "win32":
        return
    try:
        mode = stat.S_IMODE(Path(path).stat().st_mode)
    except OSError:
        return
    if mode & 0o077:
        logger.warning("the key file %s can be used by others (mode %03o): chmod 600 %s", path, mode, path)
