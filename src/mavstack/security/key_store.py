"""The user's signing keys by name: files `NAME.key` in one directory of the user.

The directory is `mavstack/keys` in the configuration directory of the platform: `$XDG_CONFIG_HOME` or
`~/.config` on Linux, `~/Library/Application Support` on macOS, `%APPDATA%` on Windows.
"""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path
from typing import Final

from mavstack.errors import SigningError
from mavstack.security.keys import SigningKey

KEY_SUFFIX: Final = ".key"
_NAME: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,63}")


def key_directory() -> Path:
    """Return the directory of the user's keys.

    Returns:
        The directory; it may not exist yet.
    """
    if sys.platform == "win32":
        base = Path(os.environ.get("APPDATA") or Path.home() / "AppData" / "Roaming")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Application Support"
    else:
        base = Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config")
    return base / "mavstack" / "keys"


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
    if not named.is_file():
        known = ", ".join(key_names()) or "none"
        raise SigningError(
            f"there is no signing key {file_or_name!r}: no file has this path, and {named.parent} has no "
            f"{named.name} (keys there: {known})"
        )
    return SigningKey.load(named)


def key_names() -> list[str]:
    """Return the names of the user's keys, in alphabetical order.

    Returns:
        The names, without the suffix of the files.

    Raises:
        SigningError: There is no home directory.
    """
    return sorted(path.stem for path in _directory().glob(f"*{KEY_SUFFIX}"))


def key_path(name: str) -> Path:
    """Return the path of a key by its name; the file need not exist.

    Args:
        name: Letters, digits, `_`, `-` and `.`, without the suffix of the file.

    Returns:
        The path in the user's key directory.

    Raises:
        SigningError: The name is not valid, or there is no home directory.
    """
    if not _NAME.fullmatch(name) or name.endswith(KEY_SUFFIX):
        raise SigningError(
            f"{name!r} is not a name of a key: up to 64 letters, digits, '_', '-' and '.', "
            f"without {KEY_SUFFIX} at the end"
        )
    return _directory() / f"{name}{KEY_SUFFIX}"


def store_key(name: str, key: SigningKey) -> Path:
    """Store a key under a name in the user's key directory, which is made if needed.

    Args:
        name: The name of the new key.
        key: The key.

    Returns:
        The path of the new file, which only its owner can read.

    Raises:
        SigningError: The name is taken or not valid, or the file cannot be written.
    """
    path = key_path(name)
    if path.exists():
        raise SigningError(f"there is a signing key {name!r} already: {path}")
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise SigningError(f"cannot make the directory {path.parent}: {error.strerror or error}") from None
    key.save(path)
    return path


def _directory() -> Path:
    try:
        return key_directory()
    except RuntimeError:  # there is no home directory
        raise SigningError("there is no home directory with keys: name the file of the key") from None
