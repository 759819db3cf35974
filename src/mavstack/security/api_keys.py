"""API keys: the text that client and server of a gate share, read from a file or from the user's keys.

The content of a file is the key, without the white space around it, so that the file of another program can
be used as it is. The API key of one of the user's signing keys is its 64 hexadecimal digits.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

from mavstack.bounded_file import read_file_bounded
from mavstack.errors import SigningError
from mavstack.security.key_store import find_key

#: Maximum length of an API key in characters.
MAX_API_KEY: Final = 4096


def read_api_key(file_or_name: str) -> str:
    """Read an API key by the path of its file, or the name of one of the user's keys.

    Args:
        file_or_name: An existing file, a text with a directory, or a name such as `fleet`.

    Returns:
        The key; do not log or store it.

    Raises:
        SigningError: There is no such key, or its file cannot be read or is no key.
    """
    path = Path(file_or_name).expanduser()
    if not path.is_file() and path.name == file_or_name:
        return find_key(file_or_name).secret_bytes().hex()
    try:
        text = read_file_bounded(path, MAX_API_KEY + 1).decode()
    except (OSError, ValueError) as error:
        raise SigningError(f"cannot read the API key {path}: {type(error).__name__}") from None
    key = text.strip()
    if not key or len(text) > MAX_API_KEY or not key.isprintable():
        raise SigningError(f"cannot read the API key {path}: it must be one line of text")
    return key
