"""The identities of this user, and the newest key offer that was accepted from each other station.

They are beside the signing keys: `identities/NAME.identity` has the secret, `NAME.public` what other stations
get, and `accepted` the time of the newest offer of each sender.
"""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Final

from mavstack.atomic_file import write_file_atomically
from mavstack.bounded_file import read_file_bounded
from mavstack.errors import SigningError
from mavstack.security.file_lock import locked
from mavstack.security.key_offer import Identity, PublicIdentity
from mavstack.security.key_store import key_path

if TYPE_CHECKING:
    from pathlib import Path

    from mavstack.security import SigningKey

MAX_FILE_SIZE: Final = 1 << 20


def make_identity(name: str) -> Path:
    """Make and store an identity.

    Args:
        name: Name of the identity; the rules are those of key names.

    Returns:
        The path of the public file.

    Raises:
        SigningError: There is an identity of this name, or it cannot be stored.
    """
    secret, public = _paths(name)
    identity = Identity.generate()
    try:
        secret.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        descriptor = os.open(secret, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(descriptor, "w", encoding="ascii") as file:
            file.write(identity.secret_bytes().hex() + "\n")
        write_file_atomically(public, identity.public.data.hex() + "\n")
    except FileExistsError:
        raise SigningError(f"there is an identity {name!r} already: {secret}") from None
    except OSError as error:
        raise SigningError(f"cannot store the identity {secret}: {error.strerror or error}") from None
    return public


def load_identity(name: str) -> Identity:
    """Read an identity of this user.

    Args:
        name: Its name.

    Returns:
        The identity.

    Raises:
        SigningError: There is none of this name, or its file is damaged.
    """
    return Identity(_read_hex(_paths(name)[0]))


def load_public(path: str | os.PathLike[str]) -> PublicIdentity:
    """Read the public identity of another station.

    Args:
        path: Path of the file.

    Returns:
        The public identity.

    Raises:
        SigningError: The file cannot be read, or is no public identity.
    """
    return PublicIdentity(_read_hex(path))


def accept_once(identity: Identity, offer: bytes, sender: PublicIdentity, now: float) -> SigningKey:
    """Accept an offer that is newer than all accepted from its sender, and remember its time.

    Args:
        identity: The recipient.
        offer: The offer.
        sender: The pinned public identity of the sender.
        now: Unix time in seconds.

    Returns:
        The key.

    Raises:
        SigningError: The offer is refused, or its time cannot be stored.
    """
    path = _paths("accepted")[0].with_suffix("")
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with locked(path):
            times = _times(path)
            key, time = identity.accept(offer, sender, now, newest=times.get(sender.fingerprint, 0))
            write_file_atomically(path, json.dumps({**times, sender.fingerprint: time}))
    except OSError as error:
        raise SigningError(f"cannot store {path}: {error.strerror or error}") from None
    return key


def _paths(name: str) -> tuple[Path, Path]:
    folder = key_path(name).parent / "identities"
    return folder / f"{name}.identity", folder / f"{name}.public"


def _times(path: Path) -> dict[str, int]:
    if not path.exists():
        return {}
    try:
        times = json.loads(read_file_bounded(path, MAX_FILE_SIZE))
        return {str(sender): int(time) for sender, time in times.items()}
    except (ValueError, AttributeError, TypeError):
        raise SigningError(f"cannot read {path}: it is damaged: old offers would pass") from None


def _read_hex(path: str | os.PathLike[str]) -> bytes:
    try:
        return bytes.fromhex(read_file_bounded(path, MAX_FILE_SIZE).decode("ascii").strip())
    except OSError as error:
        raise SigningError(f"cannot open {path}: {error.strerror or error}") from None
    except ValueError:
        raise SigningError(f"cannot read {path}: it must be hexadecimal digits") from None
