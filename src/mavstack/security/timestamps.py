"""The signing clock on disk: it only moves forward, over restarts too.

A device that starts with an older timestamp than it has used would be refused by all who heard it, and one
that accepts an older timestamp can be replayed to. The file is replaced as a whole, so a power cut leaves
either the old value or the new one.
"""

from __future__ import annotations

import os
from pathlib import Path

from mavstack.errors import SigningError

MAX_TIMESTAMP = 2**48 - 1
_MAX_DIGITS = 15
EPOCH = 1_420_070_400
UNITS_PER_SECOND = 100_000


def timestamp_at(unix_time: float) -> int:
    """The signing timestamp (10 µs since 2015-01-01 UTC) of a Unix time in seconds."""
    return min(MAX_TIMESTAMP, max(0, int((unix_time - EPOCH) * UNITS_PER_SECOND)))


def time_if_set(unix_time: float) -> float | None:
    """The time as `Signing` is to be told it: None if the clock that says it was evidently never set."""
    return unix_time if unix_time >= EPOCH else None


class TimestampStore:
    """A file that holds the newest signing timestamp used."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)

    def load(self) -> int:
        """The stored timestamp, 0 if there is none yet; raises SigningError if the file is damaged."""
        try:
            text = self.path.read_text("ascii").strip()
        except FileNotFoundError:
            return 0
        except (OSError, UnicodeDecodeError) as error:
            raise SigningError(f"{self.path}: cannot be read ({type(error).__name__})") from None
        if not text.isdecimal() or len(text) > _MAX_DIGITS or int(text) > MAX_TIMESTAMP:
            raise SigningError(
                f"{self.path}: is not a signing timestamp; remove it if its links use new keys"
            )
        return int(text)

    def store(self, timestamp: int) -> None:
        """Store `timestamp`, unless the file already holds a newer one."""
        if not 0 <= timestamp <= MAX_TIMESTAMP:
            raise SigningError(f"{timestamp} is not a signing timestamp: it has 48 bits")
        if timestamp <= self.load():
            return
        try:
            self._replace(f"{timestamp}\n")
        except OSError as error:
            raise SigningError(f"{self.path}: cannot be written ({error.strerror or error})") from None

    def _replace(self, text: str) -> None:
        new = self.path.with_name(self.path.name + ".new")
        with new.open("w", encoding="ascii") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        new.replace(self.path)
