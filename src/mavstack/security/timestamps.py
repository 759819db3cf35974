"""The signing timestamp on disk, which only increases, also over restarts.

A device that starts with an older timestamp than it has used is refused by its peers, and one that accepts
older timestamps can be attacked by replay. The file is replaced atomically, so a power failure leaves either
the old or the new value.
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
    """Convert a Unix time to a signing timestamp.

    Args:
        unix_time: The Unix time in seconds.

    Returns:
        The timestamp in 10 µs since 2015-01-01 UTC, limited to its 48 bits.
    """
    return min(MAX_TIMESTAMP, max(0, int((unix_time - EPOCH) * UNITS_PER_SECOND)))


def time_if_set(unix_time: float) -> float | None:
    """Return the time for `Signing`, or None if the system clock was evidently never set.

    Args:
        unix_time: The Unix time in seconds.

    Returns:
        The same time, or None before 2015.
    """
    return unix_time if unix_time >= EPOCH else None


class TimestampStore:
    """A file with the newest signing timestamp used.

    Args:
        path: Path of the file; it need not exist.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)

    def load(self) -> int:
        """Read the stored timestamp.

        Returns:
            The timestamp in 10 µs since 2015-01-01 UTC; 0 if the file does not exist.

        Raises:
            SigningError: The file cannot be read or is damaged.
        """
        try:
            text = self.path.read_text("ascii").strip()
        except FileNotFoundError:
            return 0
        except (OSError, UnicodeDecodeError) as error:
            raise SigningError(
                f"cannot read the signing timestamp {self.path}: {type(error).__name__}"
            ) from None
        if not text.isdecimal() or len(text) > _MAX_DIGITS or int(text) > MAX_TIMESTAMP:
            raise SigningError(
                f"cannot read the signing timestamp {self.path}: the file is damaged; "
                "remove it if its links use new keys"
            )
        return int(text)

    def store(self, timestamp: int) -> None:
        """Store a timestamp, unless the file has a newer one.

        Args:
            timestamp: The timestamp in 10 µs since 2015-01-01 UTC, such as `Signing.timestamp`.

        Raises:
            SigningError: The timestamp does not fit 48 bits, or the file cannot be read or written.
        """
        if not 0 <= timestamp <= MAX_TIMESTAMP:
            raise SigningError(f"a signing timestamp must fit 48 bits, got {timestamp}")
        if timestamp <= self.load():
            return
        try:
            self._replace(f"{timestamp}\n")
        except OSError as error:
            raise SigningError(
                f"cannot write the signing timestamp {self.path}: {error.strerror or error}"
            ) from None

    def _replace(self, text: str) -> None:
        temporary = self.path.with_name(self.path.name + ".new")
        with temporary.open("w", encoding="ascii") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(self.path)
