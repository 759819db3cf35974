"""The user's signing keys by name: files `NAME.key` in one directory of the user.

A key may be in the keyring of the operating system instead; then the directory has a file `NAME.keyring`
without the key (see `mavstack.security.os_keyring`). With the environment variable MAVSTACK_KEY_STORE=keyring
new keys go there.

The directory also has the private keys of sealed links, files `NAME.sealed`; a signing key and a key of
sealed links may have one name. `mavstack.security.sealed.keys` reads these files; listing and deleting them
needs no library.

The directory is `mavstack/keys` in the configuration directory of the platform: `$XDG_CONFIG_HOME` or
`~/.config` on Linux, `~/Library/Application Support` on macOS, `%APPDATA%` on Windows.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Final

from mavstack.atomic_file import write_file_atomically
from mavstack.errors import SigningError
from mavstack.security import os_keyring
from mavstack.security.keys import SigningKey
from mavstack.user_directories import config_directory

KEY_SUFFIX: Final = ".key"
#: The suffix of a file that represents a key in the keyring of the system.
KEYRING_SUFFIX: Final = ".keyring"
#: The suffix of the private key of sealed links.
SEALED_SUFFIX: Final = ".sealed"
#: The environment variable that determines where new keys are stored: `files` or `keyring`.
STORE_VARIABLE: Final = "MAVSTACK_KEY_STORE"
_SUFFIXES: Final = (KEY_SUFFIX, KEYRING_SUFFIX)
_NAME: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,63}")


def key_directory() -> Path:
    """Return the directory of the user's keys.

    Returns:
        The directory; it may not exist yet.
    """
    return config_directory() / "keys"


def find_key(file_or_name: str) -> SigningKey:
    """Read a key by the path of its file, or by its name in the user's key directory.

    Args:
        file_or_name: An existing file, a text with a directory, or a name such as `fleet`.

    Returns:
        The key.

    Raises:
        SigningError: There is no such key, or its file cannot be read.
    """
    path = Path(file_or_name).expanduser()
    if path.is_file() or path.name != file_or_name:
        return SigningKey.load(path)
    named = _directory() / f"{file_or_name}{KEY_SUFFIX}"
    if named.is_file():
        return SigningKey.load(named)
    if named.with_suffix(KEYRING_SUFFIX).is_file():
        return os_keyring.load_key(file_or_name)
    known = ", ".join(key_names()) or "none"
    raise SigningError(
        f"there is no signing key {file_or_name!r}: no file has this path, and {named.parent} has no "
        f"{named.name} (keys there: {known})"
    )


def load_stored_key(name: str) -> SigningKey:
    """Read a key of the user's key directory by its name; a file of this name elsewhere is not looked at.

    Args:
        name: The name of the key.

    Returns:
        The key.

    Raises:
        SigningError: There is no such key, or it cannot be read.
    """
    path = require_stored(name)
    return os_keyring.load_key(name) if path.suffix == KEYRING_SUFFIX else SigningKey.load(path)


def key_names() -> list[str]:
    """Return the names of the user's keys, in alphabetical order.

    Returns:
        The names, without the suffix of the files.

    Raises:
        SigningError: There is no home directory.
    """
    return _names(*_SUFFIXES)


def sealed_key_names() -> list[str]:
    """Return the names of the user's private keys of sealed links, in alphabetical order.

    Returns:
        The names, without the suffix of the files.

    Raises:
        SigningError: There is no home directory.
    """
    return _names(SEALED_SUFFIX)


def key_path(name: str) -> Path:
    """Return the path of a key by its name; the file need not exist.

    Args:
        name: Letters, digits, `_`, `-` and `.`, without the suffix of the file.

    Returns:
        The path in the user's key directory.

    Raises:
        SigningError: The name is not valid, or there is no home directory.
    """
    if not _NAME.fullmatch(name) or name.endswith(_SUFFIXES):
        raise SigningError(
            f"{name!r} is not a name of a key: up to 64 letters, digits, '_', '-' and '.', "
            f"without {KEY_SUFFIX} at the end"
        )
    return _directory() / f"{name}{KEY_SUFFIX}"


def sealed_key_path(name: str) -> Path:
    """Return the path of a private key of sealed links by its name; the file need not exist.

    Args:
        name: Letters, digits, `_`, `-` and `.`, without the suffix of the file.

    Returns:
        The path in the user's key directory.

    Raises:
        SigningError: The name is not valid, or there is no home directory.
    """
    return key_path(name).with_name(f"{name}{SEALED_SUFFIX}")


def find_stored(name: str) -> Path | None:
    """Return the file of a key in the user's key directory.

    Args:
        name: The name of the key.

    Returns:
        The file of the key, or the file that stands for a key in the keyring; None if there is no such key.

    Raises:
        SigningError: The name is not valid, or there is no home directory.
    """
    path = key_path(name)
    known = (path, path.with_name(f"{name}{KEYRING_SUFFIX}"))
    return next((each for each in known if each.is_file()), None)


def require_stored(name: str) -> Path:
    """Return the file of a key in the user's key directory, which must be there.

    Args:
        name: The name of the key.

    Returns:
        The file of the key, or the file that stands for a key in the keyring.

    Raises:
        SigningError: There is no such key, or the name is not valid.
    """
    path = find_stored(name)
    if path is None:
        known = ", ".join(key_names()) or "none"
        raise SigningError(f"there is no signing key {name!r} in {_directory()} (keys there: {known})")
    return path


def require_sealed(name: str) -> Path:
    """Return the file of a private key of sealed links, which must be there.

    Args:
        name: The name of the key.

    Returns:
        The file.

    Raises:
        SigningError: There is no such key, or the name is not valid.
    """
    path = sealed_key_path(name)
    if not path.is_file():
        known = ", ".join(sealed_key_names()) or "none"
        raise SigningError(
            f"there is no key {name!r} of sealed links in {path.parent} (keys of sealed links there: {known})"
        )
    return path


def uses_keyring() -> bool:
    """Return whether MAVSTACK_KEY_STORE asks for new keys in the keyring.

    Returns:
        True for `keyring`; False for `files` or nothing.

    Raises:
        SigningError: The variable has another value.
    """
    store = os.environ.get(STORE_VARIABLE) or "files"
    if store not in ("files", "keyring"):
        raise SigningError(f"{STORE_VARIABLE} must be files or keyring, got {store!r}")
    return store == "keyring"


def store_key(name: str, key: SigningKey, *, keyring: bool = False) -> Path:
    """Store a key under a name in the user's key directory, which is made if needed.

    Args:
        name: The name of the new key.
        key: The key.
        keyring: Store the key in the keyring of the system, and in the directory only its name.

    Returns:
        The path of the new file, which only its owner can read.

    Raises:
        SigningError: The name is taken or not valid, or the key cannot be stored.
        MissingExtraError: The library for the keyring is not installed.
    """
    path = key_path(name)
    if known := find_stored(name):
        raise SigningError(f"there is a signing key {name!r} already: {known}")
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise SigningError(f"cannot make the directory {path.parent}: {error.strerror or error}") from None
    if not keyring:
        key.save(path)
        return path
    os_keyring.save_key(name, key)
    path = path.with_name(f"{name}{KEYRING_SUFFIX}")
    _write(path, f"the key is in the keyring of the system, under {os_keyring.SERVICE}\n")
    return path


def replace_key(name: str, key: SigningKey) -> None:
    """Store another key under a name that exists, in one step: either key is there at any time.

    Args:
        name: The name of a key in the user's key directory.
        key: The key that takes the name.

    Raises:
        SigningError: There is no key of this name, or the key cannot be stored.
    """
    path = require_stored(name)
    if path.suffix == KEYRING_SUFFIX:
        os_keyring.save_key(name, key)
    else:
        _write(path, key.secret_bytes().hex() + "\n")


def delete_key(name: str) -> Path:
    """Delete a key from the user's key directory, and from the keyring if it is there.

    Args:
        name: The name of the key.

    Returns:
        The path of the file that was deleted.

    Raises:
        SigningError: There is no key of this name, or it cannot be deleted.
    """
    path = require_stored(name)
    if path.suffix == KEYRING_SUFFIX:
        os_keyring.delete_key(name)
    _delete(path)
    return path


def delete_sealed_key(name: str) -> Path:
    """Delete a private key of sealed links from the user's key directory.

    Args:
        name: The name of the key.

    Returns:
        The path of the file that was deleted.

    Raises:
        SigningError: There is no key of this name, or it cannot be deleted.
    """
    path = require_sealed(name)
    _delete(path)
    return path


def _names(*suffixes: str) -> list[str]:
    directory = _directory()
    return sorted({path.stem for suffix in suffixes for path in directory.glob(f"*{suffix}")})


def _delete(path: Path) -> None:
    try:
        path.unlink()
    except OSError as error:
        raise SigningError(f"cannot delete {path}: {error.strerror or error}") from None


def _write(path: Path, text: str) -> None:
    """Write a file; one that exists keeps its permissions, a new one is readable by its owner only."""
    try:
        write_file_atomically(path, text, private=True)
    except OSError as error:
        raise SigningError(f"cannot write {path}: {error.strerror or error}") from None


def _directory() -> Path:
    try:
        return key_directory()
    except RuntimeError:  # the home directory is unknown
        raise SigningError("there is no home directory with keys: name the file of the key") from None
