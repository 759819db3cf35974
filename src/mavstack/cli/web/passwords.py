"""The file of passwords of `mav web`: a password, or one for each role.

    operate     correct horse battery staple
    administer  another long sentence

A file of one line that begins with no role has the password of the role administer.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

from mavstack.bounded_file import read_file_bounded
from mavstack.cli.common.errors import CommandError
from mavstack.security.roles import Role

MAX_FILE: Final = 1 << 16
_WORDS: Final = {role.word: role for role in Role}


def read_passwords(path: str) -> dict[Role, str]:
    """Return the password of each role in a file; raises `CommandError`, which never holds a password."""
    try:
        text = read_file_bounded(Path(path).expanduser(), MAX_FILE + 1).decode()
    except (OSError, ValueError) as error:
        raise CommandError(f"cannot open {path}: {getattr(error, 'strerror', None) or error}") from None
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if len(lines) == 1 and lines[0].split()[0] not in _WORDS:
        return {Role.ADMINISTER: lines[0]}
    found: dict[Role, str] = {}
    for number, line in enumerate(lines, 1):
        word, *rest = line.split(maxsplit=1)
        if word not in _WORDS or not rest:
            raise CommandError(
                f"{path}, entry {number}: expected a role ({', '.join(_WORDS)}) and a password"
            )
        if _WORDS[word] in found:
            raise CommandError(f"{path}, entry {number}: the role {word} has two passwords")
        found[_WORDS[word]] = rest[0]
    if not found:
        raise CommandError(f"{path} has no password")
    return found
