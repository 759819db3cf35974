"""The recorder: packets of one or several links to a file, or to a series of files.

Nothing is kept in memory after `write`, so a program that is killed loses no packet that it has written, and
`sync` bounds the loss at a power failure. A new file of the series begins before the present one exceeds its
size or its duration; its number is the next free one, so that a recorder that is started again continues the
series.

Recordings hold no secrets: SETUP_SIGNING, which carries a signing key, is left out; keys, passwords and PINs
in other messages are blanked; and signatures are removed, because a collection of signed packets helps to
attack the key.
"""

from __future__ import annotations

import re
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.dialects.secrets import SECRET_IDS
from mavstack.errors import InvalidArgumentError, LogError
from mavstack.logs.recorder.formats import RECORD_FORMATS, TLOG, Records, split_records
from mavstack.logs.recorder.recording_file import RecordingFile
from mavstack.security import carries_signing_key, redact

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable
    from types import TracebackType
    from typing import Self

    from mavstack.logs.recorder.formats import RecordFormat
    from mavstack.wire import Packet, Parser

_MAX_TIME: Final = 2**63 - 1
#: Maximum step back in microseconds that is removed: packets of several links arrive out of order, and steps
#: in time slow down a replay.
_MAX_DISORDER: Final = 1_000_000
#: Ids of messages with secrets, in the official dialects: their packets are handled one by one, to change or
#: omit them.
_APART: Final = tuple(SECRET_IDS)
#: The path that means standard output.
STDOUT: Final = "-"


class Recorder:
    """A recording, open for writing; a context manager that closes it.

    Args:
        path: Path of the new file; `-` for standard output. With `max_size` or `max_duration` the files
            have a number before the suffix: `flight-0001.tlog`, `flight-0002.tlog` …
        format: The name of the format, "tlog" or "pcap"; None: that of the suffix, otherwise tlog.
        max_size: Bytes of a file before the next one begins; None: no limit.
        max_duration: Seconds of a file before the next one begins; None: no limit.
        keep: Number of files of the series that are kept, the newest ones; None keeps all.

    Attributes:
        packets: Packets written.
        bytes: Bytes written.
        omitted: SETUP_SIGNING packets that were left out.
        files: Paths of the files that were begun, oldest first.

    Raises:
        InvalidArgumentError: A limit is not positive, `keep` is given without a limit, or the format is not
            known.
        LogError: The file exists, or cannot be created.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        format: str | None = None,  # noqa: A002 (the word of open_log and of the command line)
        max_size: int | None = None,
        max_duration: float | None = None,
        keep: int | None = None,
    ) -> None:
        self._path = Path(path)
        self._format = _record_format(self._path, format)
        self._max_size, self._max_duration, self._keep = max_size, max_duration, keep
        self._check_limits()
        self.packets = self.bytes = self.omitted = 0
        self.files: list[Path] = []
        #: Records that are not written yet: their bytes and their number.
        self._records: list[Records] = []
        self._closing: list[RecordingFile] = []
        self._last_time = 0
        #: Time of the first packet of the current file, in microseconds since 1970.
        self._began: int | None = None
        self._file = self._next_file()

    @property
    def path(self) -> Path:
        """Path of the present file; `-` for standard output."""
        return self._file.path or Path(STDOUT)

    def write(self, packets: Iterable[Packet], unix_time: float) -> None:
        """Write packets that were received at one time.

        Args:
            packets: The packets.
            unix_time: The Unix time in seconds.

        Raises:
            LogError: The file cannot be written; it keeps the complete records.
        """
        self.add(packets, unix_time)
        self.flush()

    def add(self, packets: Iterable[Packet], unix_time: float) -> None:
        """Add packets that `flush` writes, together with those of other calls.

        Args:
            packets: The packets.
            unix_time: The Unix time in seconds.

        Raises:
            LogError: A full file, whose records are written now, cannot be written.
        """
        time = self._begin_at(unix_time)
        for packet in packets:
            self._add_packet(packet, time)

    def feed(self, parser: Parser, data: bytes, unix_time: float, now: float | None = None) -> int:
        """Parse bytes of a stream, and add its packets; for a tlog without an object for each packet.

        Args:
            parser: The parser of the stream.
            data: The received bytes.
            unix_time: The Unix time in seconds.
            now: The time that signatures are checked against; None: not known.

        Returns:
            The number of packets that were received.

        Raises:
            LogError: A full file, whose records are written now, cannot be written.
        """
        if self._format is not TLOG:
            packets = parser.feed(data, now)
            self.add(packets, unix_time)
            return len(packets)
        time, received = self._begin_at(unix_time), 0
        for part in parser.feed_records(data, time, _APART, now):
            if isinstance(part, tuple):
                self._records.append(Records(*part))
                received += part[1]
            else:
                self._add_packet(part, time)
                received += 1
        return received

    def _begin_at(self, unix_time: float) -> int:
        """Return the time of records in microseconds; a new file may begin before them."""
        time = self._in_order(min(max(int(unix_time * 1e6), 0), _MAX_TIME))
        if self._max_duration is not None:
            self._rotate_by_time(time)
        return time

    def _add_packet(self, packet: Packet, time: int) -> None:
        if carries_signing_key(packet):
            self.omitted += 1
        else:
            self._records.append(Records(self._format.record(redact(packet), time), 1))

    def flush(self) -> None:
        """Write what was added.

        Raises:
            LogError: The file cannot be written; it keeps the complete records.
        """
        records, self._records = self._records, []
        if self._max_size is not None:
            records = self._fill_files(records, self._max_size)
        self._append(records)

    def sync(self) -> None:
        """Wait until the system has stored the files on the disk, so that they survive a loss of power.

        It may be called from another thread than the other methods.
        """
        closing, self._closing = self._closing, []
        for file in [*closing, self._file]:
            file.sync()
        for file in closing:
            file.close()

    def close(self) -> None:
        """Write what was added, and close the recording. Idempotent.

        Raises:
            LogError: The file cannot be written; it keeps the complete records.
        """
        try:
            self.flush()
        finally:
            for file in [*self._closing, self._file]:
                file.close()

    def _append(self, records: list[Records]) -> None:
        data = b"".join([each.data for each in records])
        self._file.append(data)
        self.bytes += len(data)
        self.packets += sum(each.number for each in records)

    def _fill_files(self, records: list[Records], max_size: int) -> list[Records]:
        """Write the records that need files before the last one; return those for the last one."""
        fitting: list[Records] = []
        size = self._file.size
        waiting = deque(records)
        while waiting:
            each = waiting.popleft()
            if size + len(each.data) > max_size:
                if each.number > 1:
                    waiting.extendleft(reversed(split_records(each.data)))
                    continue
                if size > len(self._format.header):
                    self._append(fitting)
                    self._rotate()
                    fitting, size = [], self._file.size
            fitting.append(each)
            size += len(each.data)
        return fitting

    def _rotate_by_time(self, time: int) -> None:
        if self._began is not None and time - self._began >= (self._max_duration or 0.0) * 1e6:
            self.flush()
            self._rotate()
        if self._began is None:
            self._began = time

    def _rotate(self) -> None:
        file = self._next_file()
        self._closing.append(self._file)
        self._file, self._began = file, None

    def _next_file(self) -> RecordingFile:
        if str(self._path) == STDOUT:
            return RecordingFile(None, self._format.header)
        path = self._next_path() if self._is_series() else self._path
        file = RecordingFile(path, self._format.header)
        self.files.append(path)
        return file

    def _is_series(self) -> bool:
        """Return whether there are several files, with numbers."""
        return self._max_size is not None or self._max_duration is not None

    def _next_path(self) -> Path:
        """Return the path of the next number, and remove the oldest files beyond those to keep."""
        series = _series(self._path)
        number = series[-1][0] + 1 if series else 1
        if self._keep is not None:
            for _, old in series[: max(len(series) + 1 - self._keep, 0)]:
                try:
                    old.unlink(missing_ok=True)
                except OSError as error:
                    raise LogError(f"cannot remove {old}: {error.strerror or error}") from None
        return self._path.with_name(f"{self._path.stem}-{number:04}{self._path.suffix}")

    def _in_order(self, time: int) -> int:
        """Return a time that is not before the last one, unless the clock was set back."""
        if 0 < self._last_time - time < _MAX_DISORDER:
            return self._last_time
        self._last_time = time
        return time

    def _check_limits(self) -> None:
        limits = {"max_size": self._max_size, "max_duration": self._max_duration, "keep": self._keep}
        for name, limit in limits.items():
            if limit is not None and not limit > 0:
                raise InvalidArgumentError(f"{name} must be positive, got {limit!r}")
        if self._keep is not None and not self._is_series():
            raise InvalidArgumentError("keep needs max_size or max_duration")
        if self._is_series() and str(self._path) == STDOUT:
            raise InvalidArgumentError("standard output is one file: without max_size and max_duration")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _record_format(path: Path, name: str | None) -> RecordFormat:
    if name is None:
        return RECORD_FORMATS.get(path.suffix.lower().removeprefix("."), TLOG)
    if name not in RECORD_FORMATS:
        raise InvalidArgumentError(f"format must be one of {', '.join(RECORD_FORMATS)}, got {name!r}")
    return RECORD_FORMATS[name]


def _series(path: Path) -> list[tuple[int, Path]]:
    """Return the files of the series with their numbers, oldest first."""
    pattern = re.compile(re.escape(path.stem) + r"-(\d{4,9})" + re.escape(path.suffix))
    try:
        names = [entry.name for entry in path.parent.iterdir()]
    except OSError as error:
        raise LogError(f"{path}: {error.strerror or error}") from None
    matches = [match for name in names if (match := pattern.fullmatch(name))]
    return sorted((int(match[1]), path.with_name(match[0])) for match in matches)
