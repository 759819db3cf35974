"""The user's signing keys by name: files `NAME.key` in one directory of the user.

The directory is `mavstack/keys` in the configuration directory of the platform: `$XDG_CONFIG_HOME` or
`~/.config` on Linux, `~/Library/Application Support` on macOS, `%APPDATA%` on Windows.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Final

from mavstack.errors import SigningError
from mavstack.security.keys import SigningKey

KEY_SUFFIX: Final = ".key"


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
        known = ", ".join(sorted(each.stem for each in named.parent.glob(f"*{KEY_SUFFIX}"))) or "none"
        raise SigningError(
            f"there is no signing key {file_or_name!r}: no file has this path, and {named.parent} has no "
            f"{named.name} (keys there: {known})"
        )
    return SigningKey.load(named)


def _directory() -> Path:
    try:
        return key_directory()
    except RuntimeError:  # there is no home directory
        raise SigningError("there is no home directory with keys: name the file of the key") from None
