"""The signing state on disk: the newest timestamp used, and the newest one received in each stream.

A device that starts with an older timestamp than it has used is refused by its peers, and one that forgets
the packets that it has accepted executes them again when an attacker sends them again. The first line of the
file is the timestamp, which only increases, also over restarts. A line `floor` has the timestamp up to which
nothing is accepted: packets from before it may have been accepted by a run that could not store them. Each
other line is a stream: the id of its key, link id, system, component and timestamp.

A line `running` has the id of a run that has not ended, and the timestamp of its last store. A run that finds
one cannot know which packets the other has accepted since: the other was killed, or still runs. Several
processes may share a file: each change is made under a lock, merges with what is in the file, and replaces it
atomically, so that a power failure leaves either the old or the new values.
"""

from __future__ import annotations

import os
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from mavstack.atomic_file import write_file_atomically
from mavstack.errors import SigningError
from mavstack.security.file_lock import locked

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from mavstack.security.keys import SigningKey

#: The identity of a stream of signed packets: link id, system id and component id.
StreamId: TypeAlias = tuple[int, int, int]

MAX_TIMESTAMP = 2**48 - 1
#: Maximum number of streams of one key in the file; the streams with the newest timestamps are kept.
MAX_STREAMS = 1024
MAX_FILE_SIZE = 4 << 20
#: Maximum number of unfinished program runs in the file; the runs with the newest timestamps are kept.
MAX_RUNS = 64
_MAX_DIGITS = 15
_RUNNING, _FLOOR = "running", "floor"
EPOCH = 1_420_070_400
UNITS_PER_SECOND = 100_000
#: Age of its last store, in timestamp units, from which the next `store` of any program removes an unfinished
#: run. A running program stores more often. A run that began while the killed one was in the file has a floor
#: in place of its timestamps.
RUN_TIMEOUT = 600 * UNITS_PER_SECOND


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
    """The signing state that the last runs of a program left.

    Attributes:
        timestamp: The newest timestamp used, in 10 µs since 2015-01-01 UTC; 0 if there was no run.
        floor: Timestamp up to which packets of all streams are refused, because of runs before the last one.
        streams: The newest timestamp of each stream, by the id of its key.
        running: The timestamp of the last store of each run that has not ended, by the id of the run.
    """

    timestamp: int = 0
    floor: int = 0
    streams: Mapping[str, Mapping[StreamId, int]] = field(default_factory=dict)
    running: Mapping[str, int] = field(default_factory=dict)

    @property
    def is_complete(self) -> bool:
        """True if there was a run, and none has accepted packets that it has not stored."""
        return self.timestamp > 0 and not self.running

    def streams_of(self, key: SigningKey) -> dict[StreamId, int]:
        """Return the newest timestamp of each stream of a key.

        Args:
            key: The signing key.

        Returns:
            The timestamps, by link id, system and component.
        """
        return dict(self.streams.get(key.fingerprint, {}))


class TimestampStore:
    """A file with the newest signing timestamp used, and the newest one received in each stream.

    Several processes may use one file at the same time. A file with the suffix `.lock` is beside it.

    Args:
        path: Path of the file; it need not exist.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        self._run = os.urandom(8).hex()

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

    def begin_run(self, timestamp: int = 0) -> LastRun:
        """Read the whole state, and record that a run begins, so that others know if it does not end.

        Args:
            timestamp: The current time in 10 µs since 2015-01-01 UTC; 0 if it is not known.

        Returns:
            The state that the last runs left.

        Raises:
            SigningError: The file cannot be read or written, is damaged, or is locked by another process.
        """
        with self._locked():
            last = self.load_last_run()
            running = {**last.running, self._run: max(timestamp, last.timestamp)}
            self._write(replace(last, running=running))
        return last

    def store(
        self,
        timestamp: int,
        streams: Iterable[tuple[SigningKey, Mapping[StreamId, int]]] = (),
        *,
        floor: int = 0,
        running: bool = False,
    ) -> None:
        """Store a timestamp and streams; newer timestamps in the file are kept.

        Args:
            timestamp: The timestamp in 10 µs since 2015-01-01 UTC, such as `Signing.timestamp`.
            streams: For each key, the newest timestamp of its streams, as in `Signing.stream_timestamps`.
            floor: Timestamp up to which this run refuses packets of all streams.
            running: True if the program continues and stores its state again when it ends.

        Raises:
            SigningError: A timestamp does not fit 48 bits, or the file cannot be read or written, is damaged,
                or is locked by another process.
        """
        for value in (timestamp, floor):
            if not 0 <= value <= MAX_TIMESTAMP:
                raise SigningError(f"a signing timestamp must fit 48 bits, got {value}")
        with self._locked():
            last = self.load_last_run()
            state = self._merged(last, timestamp, floor, running=running)
            state = replace(state, streams=_merged_streams(last.streams, streams))
            if state != last:
                self._write(state)

    def _merged(self, last: LastRun, timestamp: int, floor: int, *, running: bool) -> LastRun:
        newest = max(timestamp, last.timestamp)
        runs = {run: at for run, at in last.running.items() if newest - at < RUN_TIMEOUT and run != self._run}
        if running:
            runs[self._run] = newest
        return LastRun(newest, max(floor, last.floor), running=runs)

    @contextmanager
    def _locked(self) -> Iterator[None]:
        with ExitStack() as stack:
            try:
                stack.enter_context(locked(self.path))
            except OSError as error:
                raise self._write_error(error) from None
            yield

    def _write(self, state: LastRun) -> None:
        try:
            write_file_atomically(self.path, _format(state))
        except OSError as error:
            raise self._write_error(error) from None

    def _write_error(self, error: OSError) -> SigningError:
        return SigningError(f"cannot write the signing timestamp {self.path}: {error.strerror or error}")


def _merged_streams(
    known: Mapping[str, Mapping[StreamId, int]], streams: Iterable[tuple[SigningKey, Mapping[StreamId, int]]]
) -> dict[str, dict[StreamId, int]]:
    """Return the streams with the newest timestamp of each."""
    merged = {name: dict(timestamps) for name, timestamps in known.items()}
    for key, newest in streams:
        timestamps = merged.setdefault(key.fingerprint, {})
        timestamps.update((stream, max(value, timestamps.get(stream, 0))) for stream, value in newest.items())
    return merged


def _format(state: LastRun) -> str:
    runs = sorted(state.running.items(), key=lambda item: item[1])[-MAX_RUNS:]
    lines = [str(state.timestamp)]
    lines += [f"{_FLOOR} {state.floor}"] * (state.floor > 0)
    lines += [f"{_RUNNING} {run} {timestamp}" for run, timestamp in runs]
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
    floor = 0
    running: dict[str, int] = {}
    streams: dict[str, dict[StreamId, int]] = {}
    for line in lines:
        match line.split(" "):
            case [word, number] if word == _FLOOR:
                floor = _number(number)
            case [word] if word == _RUNNING:  # the format of older versions
                running[""] = _number(first)
            case [word, run, number] if word == _RUNNING:
                running[run] = _number(number)
            case [name, *numbers]:
                link, system, component, value = map(_number, numbers)
                if max(link, system, component) > 255:
                    raise ValueError
                streams.setdefault(name, {})[link, system, component] = value
    return LastRun(_number(first.strip()), floor, streams, running)


def _number(text: str) -> int:
    """Parse a number of at most 48 bits."""
    if not text.isdecimal() or len(text) > _MAX_DIGITS or int(text) > MAX_TIMESTAMP:
        raise ValueError
    return int(text)
