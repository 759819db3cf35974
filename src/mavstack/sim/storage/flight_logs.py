"""The logs of one vehicle: files in its store, written while it flies, listed and fetched by others.

A log begins where its firmware begins one, usually at arming, and ends at disarming; `LogServer` gives the
logs out, and as they lie in the store, MAVLink FTP does too. What is written goes to the file every few
kilobytes, so one that is being written can be read, and what others do to the files counts: a log that
somebody removed is gone from the list.

Logs are kept up to a limit: the oldest go first, and one that has reached a third of it is ended and another
begun, so that the last part of a long flight is always there. A store that is full or broken ends the log.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING, Protocol

from mavstack.errors import LocalProtocolError
from mavstack.services.log import LogEntry

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from mavstack.services.ftp import Entry, FileStore, OpenFile
    from mavstack.services.mission import MissionItem
    from mavstack.services.parameters import Value
    from mavstack.sim.storage.sample import FlightSample, LogStart

#: All logs of a vehicle together hold so many bytes at most: about half an hour at ten samples a second.
KEPT_BYTES = 8 << 20
LEAST_KEPT = 512 << 10
#: So much is gathered before it is written to the file.
PIECE = 4096
#: So much is read at once.
BLOCK = 16384
#: So many logs are kept at most.
MOST_LOGS = 500
#: Of the year 9999.
LAST_SECOND = 253_402_300_799
_NOTHING_READ = (-1, 0, b"")


class LogWriter(Protocol):
    """Writes one log into `data`, which is emptied from time to time."""

    data: bytearray

    def write(self, sample: FlightSample) -> None:
        """Write a sample."""

    def text(self, time_us: int, severity: int, text: str) -> None:
        """Write what the vehicle says to people."""

    def mode(self, time_us: int, mode: int, reason: int = 0) -> None:
        """Write that the mode is another."""

    def armed(self, time_us: int, armed: bool, *, forced: bool = False, method: int = 0) -> None:
        """Write that the motors were armed or disarmed."""

    def event(self, time_us: int, event: int) -> None:
        """Write one of the firmware's numbered events."""

    def error(self, time_us: int, subsystem: int, code: int) -> None:
        """Write that a subsystem failed, or works again."""

    def parameter(self, time_us: int, name: str, value: Value, default: Value | None = None) -> None:
        """Write a parameter."""

    def command(self, time_us: int, item: MissionItem, sequence: int, total: int) -> None:
        """Write an item of the mission, as it is begun."""

    def home(self, time_us: int, latitude: float, longitude: float, altitude: float) -> None:
        """Write that home is there."""


class FlightLogs(ABC):
    """The logs in a store; `start` says what is known whenever one begins."""

    def __init__(self, store: FileStore, start: Callable[[], LogStart], *, limit: int = KEPT_BYTES) -> None:
        if limit < LEAST_KEPT:
            raise LocalProtocolError(f"at least {LEAST_KEPT} bytes of logs have to be kept")
        self.limit = limit
        #: Whether the store refused what was to be written last.
        self.failed = False
        self.writer: LogWriter | None = None
        self._store = store
        self._start = start
        self._file: OpenFile | None = None
        self._path = ""
        self._size = self._time_us = 0
        self._times: dict[str, int] = {}
        #: Log, offset and content of what was read last: clients fetch logs by ninety bytes.
        self._lately_read = _NOTHING_READ

    # Writing

    @property
    def writing(self) -> bool:
        """Whether a log is being written."""
        return self.writer is not None

    def begin(self, time_us: int) -> None:
        """Begin a log; one that is being written ends."""
        self.end()
        start = self._start()
        time = int(min(max(start.boot + time_us / 1e6, 0), LAST_SECOND))
        self._time_us = time_us
        self.failed = False
        try:
            self._path = self._new_path(time)
            self._make_room()
            self._file = self._store.open_file(self._path, write=True, truncate=True)
        except OSError:
            self._give_up()
            return
        self._size = 0
        self._times[self._path] = time
        self.writer = self._new_writer(start, time_us)
        self._flush()

    def end(self) -> None:
        """End the log that is being written, if there is one."""
        self._flush()
        self.writer = None
        if self._file is not None:
            with suppress(OSError):
                self._file.close()
        self._file = None

    def write(self, sample: FlightSample) -> None:
        """Write a sample, if a log is being written."""
        writer = self.writer
        if writer is not None:
            self._time_us = sample.time_us
            writer.write(sample)
            if len(writer.data) >= PIECE:
                self._flush()
                self._keep_within_limit()

    def text(self, time_us: int, severity: int, text: str) -> None:
        """Write what the vehicle says to people."""
        if self.writer is not None:
            self.writer.text(time_us, severity, text)

    def mode(self, time_us: int, mode: int, reason: int = 0) -> None:
        """Write that the mode is another, and why (the firmware's number of a reason)."""
        if self.writer is not None:
            self.writer.mode(time_us, mode, reason)

    def armed(self, time_us: int, armed: bool, *, forced: bool = False, method: int = 0) -> None:
        """Write that the motors were armed or disarmed."""
        if self.writer is not None:
            self.writer.armed(time_us, armed, forced=forced, method=method)

    def event(self, time_us: int, event: int) -> None:
        """Write one of the firmware's numbered events."""
        if self.writer is not None:
            self.writer.event(time_us, event)

    def error(self, time_us: int, subsystem: int, code: int) -> None:
        """Write that a subsystem failed, or with code 0 that it works again."""
        if self.writer is not None:
            self.writer.error(time_us, subsystem, code)

    def parameter(self, time_us: int, name: str, value: Value, default: Value | None = None) -> None:
        """Write that a parameter was set."""
        if self.writer is not None:
            self.writer.parameter(time_us, name, value, default)

    def command(self, time_us: int, item: MissionItem, sequence: int, total: int) -> None:
        """Write that an item of the mission is begun."""
        if self.writer is not None:
            self.writer.command(time_us, item, sequence, total)

    def home(self, time_us: int, latitude: float, longitude: float, altitude: float) -> None:
        """Write where home is now."""
        if self.writer is not None:
            self.writer.home(time_us, latitude, longitude, altitude)

    # As a LogStore

    def logs(self) -> Sequence[LogEntry]:
        self._flush()
        found = self._found()
        return [
            LogEntry(number, self._time_of(path, entry), entry.size)
            for number, (path, entry) in sorted(found.items())
        ]

    def read(self, number: int, offset: int, count: int, /) -> bytes:
        known, begin, content = self._lately_read
        if known != number or not begin <= offset <= offset + count <= begin + len(content):
            begin, content = offset, self._read_block(number, offset, max(count, BLOCK))
            self._lately_read = (number, begin, content)
        return content[offset - begin :][:count]

    def erase(self) -> None:
        was_writing = self.writing
        self.end()
        self._lately_read = _NOTHING_READ
        for path, _ in self._found().values():
            self._store.remove(path)
        self._times.clear()
        self._forget()
        if was_writing:
            self.begin(self._time_us)

    # What the firmwares do in their own ways

    @abstractmethod
    def _new_path(self, time: int) -> str:
        """Where the next log lies; its directory is made."""

    @abstractmethod
    def _new_writer(self, start: LogStart, time_us: int) -> LogWriter:
        """What writes it."""

    @abstractmethod
    def _found(self) -> dict[int, tuple[str, Entry]]:
        """The paths of all logs by their ids."""

    @abstractmethod
    def _time_of(self, path: str, entry: Entry) -> int:
        """When a log began."""

    def _oldest_first(self, numbers: Iterable[int]) -> list[int]:
        """The ids of logs by their age."""
        return sorted(numbers)

    @abstractmethod
    def _forget(self) -> None:
        """All logs are gone."""

    # The file

    def _flush(self) -> None:
        writer, file = self.writer, self._file
        if writer is None or file is None or not writer.data:
            return
        try:
            file.write(self._size, bytes(writer.data))
        except OSError:
            self._give_up()
            return
        self._size += len(writer.data)
        writer.data.clear()

    def _give_up(self) -> None:
        self.failed, self.writer = True, None
        self.end()

    def _keep_within_limit(self) -> None:
        if self._size >= self.limit // 3:
            self.begin(self._time_us)

    def _make_room(self) -> None:
        """Remove the oldest logs until there is place for a third of the limit."""
        self._lately_read = _NOTHING_READ
        found = self._found()
        others = deque(number for number in self._oldest_first(found) if found[number][0] != self._path)
        kept = sum(found[number][1].size for number in others)
        while others and (kept > self.limit - self.limit // 3 or len(others) >= MOST_LOGS):
            path, entry = found[others.popleft()]
            self._store.remove(path)
            self._times.pop(path, None)
            kept -= entry.size

    def _read_block(self, number: int, offset: int, size: int) -> bytes:
        found = self._found().get(number)
        if found is None:
            raise FileNotFoundError
        file = self._store.open_file(found[0])
        try:
            return file.read(offset, size)
        finally:
            file.close()

    def _list(self, path: str) -> Iterator[Entry]:
        """A directory's entries; none if it is not there."""
        with suppress(FileNotFoundError, NotADirectoryError):
            yield from self._store.list_directory(path)


def make_directories(store: FileStore, path: str) -> None:
    """Make a directory and those above it, where they are missing."""
    parts = path.strip("/").split("/")
    for length in range(1, len(parts) + 1):
        with suppress(FileExistsError):
            store.make_directory("/".join(parts[:length]))


def write_file(store: FileStore, path: str, content: bytes) -> None:
    """Put a file there, in the place of what there was."""
    file = store.open_file(path, write=True, truncate=True)
    try:
        file.write(0, content)
    finally:
        file.close()
