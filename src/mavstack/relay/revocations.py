"""The tickets that a relay does not accept any more: a file with the digest of each.

    2f1c…  # room boat, guest

The relay reads the file again when it has changed. The file shows no ticket: a digest opens nothing.
"""

from __future__ import annotations

import re
from hashlib import sha256
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError, LinkError
from mavstack.security.room_tickets import read_room

if TYPE_CHECKING:
    from pathlib import Path

#: Seconds between two checks of the file.
READ_INTERVAL: Final = 1.0
MAX_FILE: Final = 8 << 20
_LINE: Final = re.compile(r"([0-9a-f]{64})\s*(?:#.*)?", re.ASCII)


class Revocations:
    """The revoked tickets of a file, which need not be there yet.

    Args:
        path: The file; None: no ticket is revoked.

    Raises:
        LinkError: The file cannot be read, or has a malformed line.
    """

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._stamp: tuple[int, int] | None = None
        self._digests: frozenset[str] = frozenset()
        self.read()

    def read(self) -> bool:
        """Read the file again if it has changed; return whether it has.

        Raises:
            LinkError: The file cannot be read, or has a malformed line; the tickets stay as they were.
        """
        if self._path is None:
            return False
        try:
            found = self._path.stat()
            stamp = (found.st_mtime_ns, found.st_size)
            if stamp == self._stamp:
                return False
            with self._path.open(encoding="ascii", errors="replace") as file:
                text = file.read(MAX_FILE + 1)
        except FileNotFoundError:
            changed, self._stamp, self._digests = self._stamp is not None, None, frozenset()
            return changed
        except OSError as error:
            raise LinkError(f"reading the revoked tickets {self._path} failed: {error.strerror}") from error
        self._stamp = stamp  # also of a malformed file, so that each change of the file is reported once
        self._digests = self._parse(text)
        return True

    def has(self, ticket: str) -> bool:
        """Return whether a ticket is revoked."""
        return digest_of(ticket) in self._digests

    def _parse(self, text: str) -> frozenset[str]:
        if len(text) > MAX_FILE:
            raise LinkError(
                f"reading the revoked tickets {self._path} failed: it is longer than {MAX_FILE} bytes"
            )
        digests: set[str] = set()
        for number, line in enumerate(text.splitlines(), 1):
            match = _LINE.fullmatch(line.strip())
            if match is not None:
                digests.add(match[1])
            elif line.strip() and not line.startswith("#"):
                raise LinkError(
                    f"reading the revoked tickets {self._path} failed: line {number} is not a digest; "
                    "mav relay revoke writes them"
                )
        return frozenset(digests)


def revoke(ticket: str, path: Path) -> bool:
    """Add a ticket to a file of revoked tickets.

    Args:
        ticket: The ticket.
        path: The file.

    Returns:
        False if it is there already.

    Raises:
        InvalidArgumentError: The text is not a ticket, or the file cannot be written.
        LinkError: The file cannot be read.
    """
    room, seat = read_room(ticket)
    if Revocations(path).has(ticket):
        return False
    try:
        with path.open("a+b") as file:
            # after an incomplete last line the digest would be part of its comment
            file.seek(max(0, file.tell() - 1))
            start = "\n" if file.read(1) not in {b"", b"\n"} else ""
            file.write(f"{start}{digest_of(ticket)}  # room {room}, {seat}\n".encode("ascii"))
    except OSError as error:
        raise InvalidArgumentError(f"writing {path} failed: {error.strerror}") from None
    return True


def digest_of(ticket: str) -> str:
    """Return the digest of a ticket."""
    return sha256(ticket.encode()).hexdigest()
