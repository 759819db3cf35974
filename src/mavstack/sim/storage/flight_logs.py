"""Onboard logs of one vehicle: files in its store, written in flight, listed and downloaded by clients.

A log starts when its firmware starts one, usually at arming, and ends at disarming. `LogServer` serves the
logs, and because they are files of the store, MAVLink FTP does too. Data are written to the file every few
kilobytes, so that an open log can be read, and changes to the files take effect: a removed log disappears
from the list.

Logs are kept up to a capacity: the oldest are removed first, and a log that reaches a third of the capacity
is closed and continued in another, so that the last part of a long flight is always kept. A store that is
full or broken ends the log.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING, Protocol

from mavstack.errors import InvalidArgumentError
from mavstack.services.log import LogEntry

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from mavstack.services.ftp import Entry, FileStore, OpenFile
    from mavstack.services.mission import MissionItem
    from mavstack.services.parameters import Value
    from mavstack.sim.storage.sample import FlightSample, LogStart

#: Maximum bytes of all logs of a vehicle: about half an hour at ten samples per second.
DEFAULT_LOG_CAPACITY = 8 << 20
MIN_LOG_CAPACITY = 512 << 10
#: Number of bytes that are buffered before they are written to the file.
FLUSH_SIZE = 4096
#: Number of bytes in one read of a file.
READ_SIZE = 16384
#: Maximum number of logs.
MAX_LOGS = 500
#: Maximum Unix time, the end of the year 9999.
MAX_TIME = 253_402_300_799
_EMPTY_CACHE = (-1, 0, b"")


class LogWriter(Protocol):
    """Writer of one log into `data`, which the caller empties from time to time."""

    data: bytearray

    def write(self, sample: FlightSample) -> None:
        """Write a sample."""

    def text(self, time_us: int, severity: int, text: str) -> None:
        """Write a status text."""

    def mode(self, time_us: int, mode: int, reason: int = 0) -> None:
        """Write a mode change; `reason` is the firmware's number."""

    def armed(self, time_us: int, armed: bool, *, forced: bool = False, method: int = 0) -> None:
        """Write that the motors were armed or disarmed."""

    def event(self, time_us: int, event: int) -> None:
        """Write one of the firmware's numbered events."""

    def error(self, time_us: int, subsystem: int, code: int) -> None:
        """Write the failure of a subsystem; code 0 is its recovery."""

    def parameter(self, time_us: int, name: str, value: Value, default: Value | None = None) -> None:
        """Write a parameter."""

    def command(self, time_us: int, item: MissionItem, sequence: int, total: int) -> None:
        """Write a mission item when it starts."""

    def home(self, time_us: int, latitude: float, longitude: float, altitude: float) -> None:
        """Write the home position in degrees and metres AMSL."""


class FlightLogs(ABC):
    """The logs in a store.

    Args:
        store: Where the files are.
        start: Returns the facts to write at the start of a log.
        capacity: Maximum bytes of all logs together.

    Raises:
        InvalidArgumentError: The capacity is too small.
    """

    def __init__(
        self, store: FileStore, start: Callable[[], LogStart], *, capacity: int = DEFAULT_LOG_CAPACITY
    ) -> None:
        if capacity < MIN_LOG_CAPACITY:
            raise InvalidArgumentError(f"capacity must be at least {MIN_LOG_CAPACITY} bytes, got {capacity}")
        self.capacity = capacity
        #: True if the last write to the store failed.
        self.failed = False
        self.writer: LogWriter | None = None
        #: Writers of log streams. They get the same records as the log; the component that added one empties
        #: its buffer.
        self.streams: list[LogWriter] = []
        self._store = store
        self._start = start
        self._file: OpenFile | None = None
        self._path = ""
        self._size = self._time_us = 0
        self._times: dict[str, int] = {}
        #: The last block that was read: log number, offset and content. Clients download logs in pieces of 90
        #: bytes.
        self._read_cache = _EMPTY_CACHE

    # Writing

    @property
    def writing(self) -> bool:
        """True while a log is open."""
        return self.writer is not None

    @property
    def recording(self) -> bool:
        """True while a log or a stream is open."""
        return self.writer is not None or bool(self.streams)

    def open_stream(self, time_us: int) -> LogWriter:
        """Open a stream, and return its writer with the start of a log."""
        writer = self._new_writer(self._start(), time_us)
        self.streams.append(writer)
        return writer

    def begin(self, time_us: int) -> None:
        """Start a log and end the open one."""
        self.end()
        start = self._start()
        time = int(min(max(start.boot + time_us / 1e6, 0), MAX_TIME))
        self._time_us = time_us
        self.failed = False
        try:
            self._path = self._new_path(time)
            self._make_room()
            self._file = self._store.open_file(self._path, write=True, truncate=True)
        except OSError:
            self._fail()
            return
        self._size = 0
        self._times[self._path] = time
        self.writer = self._new_writer(start, time_us)
        self._flush()

    def end(self) -> None:
        """End the open log, if any."""
        self._flush()
        self.writer = None
        if self._file is not None:
            with suppress(OSError):
                self._file.close()
        self._file = None

    def write(self, sample: FlightSample) -> None:
        """Write a sample to the open log, if any."""
        for stream in self.streams:
            stream.write(sample)
        writer = self.writer
        if writer is not None:
            self._time_us = sample.time_us
            writer.write(sample)
            if len(writer.data) >= FLUSH_SIZE:
                self._flush()
                self._split_if_large()

    def text(self, time_us: int, severity: int, text: str) -> None:
        """Write a status text."""
        for writer in self._writers():
            writer.text(time_us, severity, text)

    def mode(self, time_us: int, mode: int, reason: int = 0) -> None:
        """Write a mode change; `reason` is the firmware's number."""
        for writer in self._writers():
            writer.mode(time_us, mode, reason)

    def armed(self, time_us: int, armed: bool, *, forced: bool = False, method: int = 0) -> None:
        """Write that the motors were armed or disarmed."""
        for writer in self._writers():
            writer.armed(time_us, armed, forced=forced, method=method)

    def event(self, time_us: int, event: int) -> None:
        """Write one of the firmware's numbered events."""
        for writer in self._writers():
            writer.event(time_us, event)

    def error(self, time_us: int, subsystem: int, code: int) -> None:
        """Write the failure of a subsystem; code 0 is its recovery."""
        for writer in self._writers():
            writer.error(time_us, subsystem, code)

    def parameter(self, time_us: int, name: str, value: Value, default: Value | None = None) -> None:
        """Write a parameter."""
        for writer in self._writers():
            writer.parameter(time_us, name, value, default)

    def command(self, time_us: int, item: MissionItem, sequence: int, total: int) -> None:
        """Write a mission item when it starts."""
        for writer in self._writers():
            writer.command(time_us, item, sequence, total)

    def home(self, time_us: int, latitude: float, longitude: float, altitude: float) -> None:
        """Write the home position in degrees and metres AMSL."""
        for writer in self._writers():
            writer.home(time_us, latitude, longitude, altitude)

    # Implementation of LogStore

    def logs(self) -> Sequence[LogEntry]:
        self._flush()
        found = self._existing_logs()
        return [
            LogEntry(number, self._time_of(path, entry), entry.size)
            for number, (path, entry) in sorted(found.items())
        ]

    def read(self, number: int, offset: int, count: int, /) -> bytes:
        known, begin, content = self._read_cache
        if known != number or not begin <= offset <= offset + count <= begin + len(content):
            begin, content = offset, self._read_block(number, offset, max(count, READ_SIZE))
            self._read_cache = (number, begin, content)
        return content[offset - begin :][:count]

    def erase(self) -> None:
        was_writing = self.writing
        self.end()
        self._read_cache = _EMPTY_CACHE
        for path, _ in self._existing_logs().values():
            self._store.remove(path)
        self._times.clear()
        self._clear_index()
        if was_writing:
            self.begin(self._time_us)

    # Implemented by the logs of each firmware

    @abstractmethod
    def _new_path(self, time: int) -> str:
        """Return the path of the next log, after creating its directory."""

    @abstractmethod
    def _new_writer(self, start: LogStart, time_us: int) -> LogWriter:
        """Return the writer of a new log."""

    @abstractmethod
    def _existing_logs(self) -> dict[int, tuple[str, Entry]]:
        """Return path and entry of each log by id."""

    @abstractmethod
    def _time_of(self, path: str, entry: Entry) -> int:
        """Return the Unix time at which a log started."""

    def _oldest_first(self, numbers: Iterable[int]) -> list[int]:
        """Return the ids of logs, oldest first."""
        return sorted(numbers)

    @abstractmethod
    def _clear_index(self) -> None:
        """Discard the index after all logs were erased."""

    # Access to the file

    def _writers(self) -> list[LogWriter]:
        """Return the writers of the open log and of the streams."""
        return self.streams if self.writer is None else [self.writer, *self.streams]

    def _flush(self) -> None:
        """Write buffered data to the file."""
        writer, file = self.writer, self._file
        if writer is None or file is None or not writer.data:
            return
        try:
            file.write(self._size, bytes(writer.data))
        except OSError:
            self._fail()
            return
        self._size += len(writer.data)
        writer.data.clear()

    def _fail(self) -> None:
        """End the log after a failure of the store."""
        self.failed, self.writer = True, None
        self.end()

    def _split_if_large(self) -> None:
        """Continue in a new log when this one has reached its share of the capacity."""
        if self._size >= self.capacity // 3:
            self.begin(self._time_us)

    def _make_room(self) -> None:
        """Remove the oldest logs until a third of the capacity is free."""
        self._read_cache = _EMPTY_CACHE
        found = self._existing_logs()
        others = deque(number for number in self._oldest_first(found) if found[number][0] != self._path)
        kept = sum(found[number][1].size for number in others)
        while others and (kept > self.capacity - self.capacity // 3 or len(others) >= MAX_LOGS):
            path, entry = found[others.popleft()]
            self._store.remove(path)
            self._times.pop(path, None)
            kept -= entry.size

    def _read_block(self, number: int, offset: int, size: int) -> bytes:
        """Read a part of a log."""
        found = self._existing_logs().get(number)
        if found is None:
            raise FileNotFoundError
        file = self._store.open_file(found[0])
        try:
            return file.read(offset, size)
        finally:
            file.close()

    def _list(self, path: str) -> Iterator[Entry]:
        """Return a directory's entries; none if it does not exist."""
        with suppress(FileNotFoundError, NotADirectoryError):
            yield from self._store.list_directory(path)


def make_directories(store: FileStore, path: str) -> None:
    """Create a directory and its parents where they are missing."""
    parts = path.strip("/").split("/")
    for length in range(1, len(parts) + 1):
        with suppress(FileExistsError):
            store.make_directory("/".join(parts[:length]))


def write_file(store: FileStore, path: str, content: bytes) -> None:
    """Write a file, replacing its content."""
    file = store.open_file(path, write=True, truncate=True)
    try:
        file.write(0, content)
    finally:
        file.close()
