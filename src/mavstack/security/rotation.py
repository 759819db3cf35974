"""The rotation of a stored key: the names under which the old and the new key are kept meanwhile.

    begin      NAME is the old key; the new one is stored as NAME.next, before any vehicle gets it
    vehicles   each changes from NAME to NAME.next
    finish     the old key is stored as NAME.old-FINGERPRINT; NAME becomes the new key; NAME.next is deleted

Each step can be repeated, and the program may be killed between any two: both keys are stored at any time,
so that every vehicle can be reached with one of them. A rotation that was interrupted continues with the key
that it began with. Old keys are never deleted, since a vehicle that was off still uses its old key.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from mavstack.errors import SigningError
from mavstack.security.key_store import (
    KEYRING_SUFFIX,
    delete_key,
    find_stored,
    key_path,
    load_stored_key,
    replace_key,
    store_key,
)
from mavstack.security.keys import SigningKey

NEXT_SUFFIX: Final = ".next"
_FINGERPRINT_DIGITS: Final = 8


@dataclass(frozen=True, slots=True)
class Rotation:
    """A rotation that has begun.

    Attributes:
        name: The name of the key in the user's key directory.
        old: The key that vehicles change from.
        new: The key that they change to.
        resumed: True if the rotation began earlier and was interrupted.
    """

    name: str
    old: SigningKey
    new: SigningKey
    resumed: bool

    @property
    def next_name(self) -> str:
        """The name of the new key until the rotation is finished."""
        return f"{self.name}{NEXT_SUFFIX}"

    @property
    def old_name(self) -> str:
        """The name of the old key after the rotation is finished."""
        return f"{self.name}.old-{self.old.fingerprint[:_FINGERPRINT_DIGITS]}"

    def finish(self) -> None:
        """Give the new key the name of the old one, and keep the old one.

        Raises:
            SigningError: A key cannot be stored; the rotation can be finished later.
        """
        if self.old != self.new:  # equal if an earlier call was interrupted after `replace_key`
            if find_stored(self.old_name) is None:
                store_key(self.old_name, self.old, keyring=_is_in_keyring(self.name))
            elif load_stored_key(self.old_name) != self.old:
                raise SigningError(f"another key has the name {self.old_name}: rename it")
            replace_key(self.name, self.new)
        delete_key(self.next_name)


def begin_rotation(name: str) -> Rotation:
    """Begin the rotation of a key, or resume the one that was interrupted.

    Args:
        name: The name of a key in the user's key directory.

    Returns:
        The rotation; its new key is stored.

    Raises:
        SigningError: There is no key of this name, the name is too long, or the new key cannot be stored.
    """
    old, next_name = load_stored_key(name), f"{name}{NEXT_SUFFIX}"
    # raises if the name of the old key would be too long
    key_path(Rotation(name, old, old, resumed=False).old_name)
    if find_stored(next_name) is not None:
        return Rotation(name, old, load_stored_key(next_name), resumed=True)
    new = SigningKey.generate()
    store_key(next_name, new, keyring=_is_in_keyring(name))
    return Rotation(name, old, new, resumed=False)


def _is_in_keyring(name: str) -> bool:
    path = find_stored(name)
    return path is not None and path.suffix == KEYRING_SUFFIX
