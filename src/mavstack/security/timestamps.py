"""The signing state on disk: the newest timestamp used, and the newest one received in each stream.

A device that starts with an older timestamp than it has used is refused by its peers, and one that forgets
the packets that it has accepted executes them again when an attacker sends them again. The first line of the
file is the timestamp, which only increases, also over restarts. Each further line is a stream: the id of its
key, link id, system, component and timestamp. The line `running` says that the program has not ended yet; a
file that has it at the start was left by a program that was killed. The file is replaced atomically, so a
power failure leaves either the old or the new values.
"""

from __future__ import annotations

import hashlib
import hmac
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from mavstack.errors import SigningError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mavstack.security.keys import SigningKey

#: Link id, system and component of a stream.
StreamId: TypeAlias = tuple[int, int, int]

MAX_TIMESTAMP = 2**48 - 1
#: Streams of one key in the file; those with the newest timestamps are kept.
MAX_STREAMS = 1024
MAX_FILE_SIZE = 4 << 20
_MAX_DIGITS = 15
_RUNNING = "running"
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


@dataclass(frozen=True, slots=True)
class LastRun:
    """The signing state that the last run of a program left.

    Attributes:
        timestamp: The newest timestamp used, in 10 µs since 2015-01-01 UTC; 0 if there was no run.
        interrupted: True if the run did not end properly: it may have used and accepted newer timestamps.
        streams: The newest timestamp of each stream, by the id of its key.
    """

    timestamp: int = 0
    interrupted: bool = False
    streams: Mapping[str, Mapping[StreamId, int]] = field(default_factory=dict)

    def streams_of(self, key: SigningKey) -> dict[StreamId, int]:
        """Return the newest timestamp of each stream of a key.

        Args:
            key: The signing key.

        Returns:
            The timestamps, by link id, system and component.
        """
        return dict(self.streams.get(_key_id(key), {}))


class TimestampStore:
    """A file with the newest signing timestamp used, and the newest one received in each stream.

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
        return self.load_last_run().timestamp

    def load_last_run(self) -> LastRun:
        """Read the whole state.

        Returns:
            The state that the last run left.

        Raises:
            SigningError: The file cannot be read or is damaged.
        """
        try:
            with self.path.open("r", encoding="ascii") as file:
                text = file.read(MAX_FILE_SIZE + 1)
        except FileNotFoundError:
            return LastRun()
        except (OSError, UnicodeDecodeError) as error:
            raise SigningError(
                f"cannot read the signing timestamp {self.path}: {type(error).__name__}"
            ) from None
        try:
            return _parse(text)
        except ValueError:
            raise SigningError(
                f"cannot read the signing timestamp {self.path}: the file is damaged; "
                "remove it if its links use new keys"
            ) from None

    def mark_running(self) -> None:
        """Record that a program runs, so that the next run notices if this one was killed.

        Raises:
            SigningError: The file cannot be read or written.
        """
        last = self.load_last_run()
        if not last.interrupted:
            self._write(LastRun(last.timestamp, True, last.streams))

    def store(
        self,
        timestamp: int,
        streams: Iterable[tuple[SigningKey, Mapping[StreamId, int]]] = (),
        *,
        running: bool = False,
    ) -> None:
        """Store a timestamp and streams; newer timestamps in the file are kept.

        Args:
            timestamp: The timestamp in 10 µs since 2015-01-01 UTC, such as `Signing.timestamp`.
            streams: For each key, the newest timestamp of its streams, as in `Signing.stream_timestamps`.
            running: True if the program continues and stores its state again when it ends.

        Raises:
            SigningError: The timestamp does not fit 48 bits, or the file cannot be read or written.
        """
        if not 0 <= timestamp <= MAX_TIMESTAMP:
            raise SigningError(f"a signing timestamp must fit 48 bits, got {timestamp}")
        last = self.load_last_run()
        merged = {name: dict(known) for name, known in last.streams.items()}
        for key, newest in streams:
            known = merged.setdefault(_key_id(key), {})
            known.update((stream, max(value, known.get(stream, 0))) for stream, value in newest.items())
        state = LastRun(max(timestamp, last.timestamp), running, merged)
        if state != last:
            self._write(state)

    def _write(self, state: LastRun) -> None:
        try:
            self._replace(_format(state))
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


def _key_id(key: SigningKey) -> str:
    """Return an id of a key from which the key cannot be calculated."""
    return hmac.digest(key.secret_bytes(), b"mavstack signing streams", hashlib.sha256)[:8].hex()


def _format(state: LastRun) -> str:
    lines = [str(state.timestamp)] + [_RUNNING] * state.interrupted
    for name, streams in state.streams.items():
        newest = sorted(streams.items(), key=lambda item: item[1])[-MAX_STREAMS:]
        lines += [
            f"{name} {link} {system} {component} {value}" for (link, system, component), value in newest
        ]
    return "\n".join(lines) + "\n"


def _parse(text: str) -> LastRun:
    """Parse a file; raises ValueError if it is damaged."""
    if len(text) > MAX_FILE_SIZE:
        raise ValueError
    first, *lines = text.strip().split("\n")
    interrupted = lines[:1] == [_RUNNING]
    streams: dict[str, dict[StreamId, int]] = {}
    for line in lines[interrupted:]:
        name, *numbers = line.split(" ")
        link, system, component, value = map(_number, numbers)
        if max(link, system, component) > 255:
            raise ValueError
        streams.setdefault(name, {})[link, system, component] = value
    return LastRun(_number(first.strip()), interrupted, streams)


def _number(text: str) -> int:
    """Parse a number of at most 48 bits."""
    if not text.isdecimal() or len(text) > _MAX_DIGITS or int(text) > MAX_TIMESTAMP:
        raise ValueError
    return int(text)
