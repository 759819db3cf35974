"""Signing keys in the keyring of the operating system, instead of in files.

The keyring is Secret Service or KWallet on Linux, the Keychain on macOS, the Credential Manager on Windows,
through the library `keyring` (extra `secure`). It is locked while the user is not logged in, which a file is
not. A keyring cannot list its entries, so the key directory has a file `NAME.keyring` for each key in it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Protocol, TypeVar

from mavstack.errors import MissingExtraError, SigningError
from mavstack.security.keys import SigningKey

if TYPE_CHECKING:
    from collections.abc import Callable

Value = TypeVar("Value")

#: The service name of the keys in the keyring of the system.
SERVICE: Final = "mavstack signing keys"


class Keyring(Protocol):
    """The functions of the library `keyring` that are used."""

    def get_password(self, service_name: str, username: str) -> str | None:
        """Return a secret, or None."""

    def set_password(self, service_name: str, username: str, password: str) -> None:
        """Store a secret; replace the one that is there."""

    def delete_password(self, service_name: str, username: str) -> None:
        """Delete a secret."""


def load_key(name: str) -> SigningKey:
    """Read a key from the keyring.

    Args:
        name: The name of the key.

    Returns:
        The key.

    Raises:
        SigningError: The keyring does not have it, or cannot be used.
        MissingExtraError: The library is not installed.
    """
    text = _use("read", name, lambda keyring: keyring.get_password(SERVICE, name))
    if text is None:
        raise SigningError(f"cannot read the key {name!r}: the keyring of the system does not have it")
    try:
        return SigningKey.from_hex(text)
    except SigningError as error:
        raise SigningError(f"cannot read the key {name!r} from the keyring of the system: {error}") from None


def save_key(name: str, key: SigningKey) -> None:
    """Write a key to the keyring, and read it back.

    Args:
        name: The name of the key; a key that has it already is replaced.
        key: The key.

    Raises:
        SigningError: The keyring cannot be used, or does not return the key.
        MissingExtraError: The library is not installed.
    """
    secret = key.secret_bytes().hex()
    _use("store", name, lambda keyring: keyring.set_password(SERVICE, name, secret))
    if load_key(name) != key:
        raise SigningError(f"cannot store the key {name!r}: the keyring of the system returns another one")


def delete_key(name: str) -> None:
    """Delete a key from the keyring.

    Args:
        name: The name of the key.

    Raises:
        SigningError: The keyring does not have it, or cannot be used.
        MissingExtraError: The library is not installed.
    """
    _use("delete", name, lambda keyring: keyring.delete_password(SERVICE, name))


def _use(operation: str, name: str, function: Callable[[Keyring], Value]) -> Value:
    """Call a function of the keyring; no error that it raises may show the secret."""
    keyring = _keyring()
    try:
        return function(keyring)
    except Exception as error:  # noqa: BLE001 (each backend has errors of its own)
        reason = type(error).__name__
        raise SigningError(
            f"cannot {operation} the key {name!r} in the keyring of the system: {reason}; "
            "keys in files need no keyring"
        ) from None


def _keyring() -> Keyring:
    try:
        import keyring
    except ImportError:
        raise MissingExtraError("the keyring of the system", "secure") from None
    return keyring
