"""The keys of sealed links: an X25519 key in a file of its owner, and the public keys of peers.

A private key is a file `NAME.sealed` in the directory of the user's keys: 64 hexadecimal digits, readable by
its owner only. A public key is given as 64 hexadecimal digits, or as a file with a line for each key: the
digits, and a name.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

from mavstack.bounded_file import read_file_bounded
from mavstack.errors import SigningError
from mavstack.security.key_store import sealed_key_path
from mavstack.security.keys import SigningKey
from mavstack.security.sealed.noise import KEY_SIZE, public_of

#: Maximum size of a file with public keys in bytes.
MAX_PEERS_FILE: Final = 1 << 16
_MAX_NAME: Final = 64


def new_private_key(name: str) -> Path:
    """Make a private key under a name in the user's key directory, which is made if needed.

    Args:
        name: The name of the new key.

    Returns:
        The path of the new file, which only its owner can read.

    Raises:
        SigningError: The name is taken or not valid, or the file cannot be written.
    """
    path = sealed_key_path(name)
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise SigningError(f"cannot make the directory {path.parent}: {error.strerror or error}") from None
    SigningKey(os.urandom(KEY_SIZE)).save(path)
    return path


def read_private_key(file_or_name: str) -> bytes:
    """Read a private key by the path of its file, or by its name.

    Args:
        file_or_name: An existing file, a text with a directory, or a name such as `boat`.

    Returns:
        The 32 bytes of the key; do not log or store them.

    Raises:
        SigningError: There is no such key, or its file cannot be read.
    """
    path = Path(file_or_name).expanduser()
    if not path.is_file() and path.name == file_or_name:
        path = sealed_key_path(file_or_name)
        if not path.is_file():
            raise SigningError(
                f"there is no key {file_or_name!r} of sealed links: {path} does not exist; "
                f"mav key new --sealed {file_or_name} makes it"
            )
    return SigningKey.load(path).secret_bytes()


def public_key(private_key: bytes) -> bytes:
    """Return the public key of a private key.

    Args:
        private_key: The 32 bytes of the private key.

    Returns:
        The 32 bytes of the public key.
    """
    return public_of(private_key)


def read_peers(text: str) -> dict[bytes, str]:
    """Read the public keys of peers.

    Args:
        text: 64 hexadecimal digits, the path of a file of such lines, or several of both with commas.

    Returns:
        The name of each key; without a name in the file, the first 16 digits.

    Raises:
        SigningError: A key is malformed, or a file cannot be read.
    """
    peers: dict[bytes, str] = {}
    for word in filter(None, (each.strip() for each in text.split(","))):
        peers.update([_peer(word)] if _is_key(word) else _read_file(Path(word).expanduser()))
    if not peers:
        raise SigningError("there is no public key of a peer")
    return peers


def _read_file(path: Path) -> list[tuple[bytes, str]]:
    try:
        text = read_file_bounded(path, MAX_PEERS_FILE).decode()
    except (OSError, ValueError) as error:
        raise SigningError(
            f"cannot read the public keys {path}: {type(error).__name__} "
            "(a public key has 64 hexadecimal digits; mav key public NAME prints it)"
        ) from None
    peers = []
    for number, line in enumerate(text.splitlines(), 1):
        content = line.partition("#")[0].strip()
        if content and not _is_key(content.split()[0]):
            raise SigningError(f"{path}, line {number}: a public key must have 64 hexadecimal digits")
        if content:
            peers.append(_peer(*content.split(maxsplit=1)))
    return peers


def _peer(digits: str, name: str = "") -> tuple[bytes, str]:
    shown = "".join(each for each in name if each.isprintable())[:_MAX_NAME]
    return bytes.fromhex(digits), shown or digits[:16].lower()


def _is_key(word: str) -> bool:
    return len(word) == 2 * KEY_SIZE and set(word) <= set("0123456789abcdefABCDEF")
