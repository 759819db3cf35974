"""tlog: the packets of a log byte for byte, each with the time at which it was received.

Only a log of packets (tlog, raw stream, capture) can become a tlog: the rows of other formats are not
packets. Signatures, SETUP_SIGNING and secrets are left out, as in recordings (`mavstack.logs.recorder`).

A raw stream has no times. Its packets get those of the vehicle's clock: the time since boot of the last
message that has one, plus the offset to UTC if SYSTEM_TIME tells it; without it the file begins in 1970.
A packet of another log whose time is not known, as after damage, gets that of the packet before.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final

from mavstack.errors import LogError
from mavstack.logs.export.registry import LogExporter
from mavstack.logs.export.writer import ExportOptions, ExportWriter, PartFile, counted, nothing_to_write
from mavstack.logs.packets.packet_record import PacketRecord
from mavstack.logs.recorder.formats import TLOG as TLOG_FORMAT
from mavstack.security import carries_signing_key, redact

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from mavstack.logs.export.writer import Progress
    from mavstack.logs.log import Log
    from mavstack.wire import Packet

_TIMESTAMP: Final = 8
_MAX_TIME: Final = 2**63 - 1
#: Formats whose logs hold packets.
_PACKET_FORMATS: Final = ("tlog", "raw", "pcap")
#: Packets between two calls of `progress`.
_PROGRESS_STEP: Final = 1 << 14
#: Fields with the time since boot, and their unit in microseconds; larger values are UTC.
_BOOT_FIELDS: Final = (("time_boot_ms", 1000), ("time_usec", 1))
_MAX_BOOT_US: Final = 10**15


class TlogWriter(ExportWriter):
    """Writes the packets of a log into a tlog."""

    def __init__(self, log: Log, path: Path, options: ExportOptions) -> None:
        super().__init__(log, path, options)
        if log.format not in _PACKET_FORMATS:
            kind = "merged log" if log.format == "merged" else f"{log.format} log"
            raise LogError(
                f"cannot write {path}: {log.path} is a {kind}, and a tlog holds packets as they were "
                f"received; only logs of packets ({', '.join(_PACKET_FORMATS)}) can be converted to tlog"
            )
        self._file = PartFile(path)
        self._omitted = 0

    def write_log(self, names: Sequence[str], progress: Progress) -> Mapping[str, int]:
        """Write the packets; see `ExportWriter.write_log`."""
        rows: Counter[str] = Counter()
        clock = self._clock()
        done = 0
        with self._file.temporary.open("wb") as file:
            for number, packet in enumerate(self._packets(names)):
                time = clock.time_of(packet)
                if carries_signing_key(packet):
                    self._omitted += 1
                else:
                    file.write(TLOG_FORMAT.record(redact(packet), time))
                    rows[packet.name or ""] += 1
                done += len(packet.raw) + _TIMESTAMP
                if progress is not None and not number % _PROGRESS_STEP:
                    progress(min(done, self.log.size), self.log.size)
        if not rows:
            raise nothing_to_write(self.log)
        if progress is not None:
            progress(self.log.size, self.log.size)
        return rows

    def _clock(self) -> StreamClock | ReceiveClock:
        if self.log.format == "raw":
            return StreamClock(self.log.time_base.offset_us or 0)
        span = self.log.time_span
        return ReceiveClock(0 if span is None else round(span[0] * 1e6))

    def _packets(self, names: Sequence[str]) -> Iterator[Packet]:
        for record in self.log.records(*names):
            if not isinstance(record, PacketRecord):
                raise LogError(f"cannot write {self.path}: {self.log.path} has no times to select packets by")
            yield record.packet

    def describe(self, rows: Mapping[str, int]) -> str:
        """Return the number of packets; see `ExportWriter.describe`."""
        omitted = f" (without {self._omitted} SETUP_SIGNING)" if self._omitted else ""
        return f"{counted(sum(rows.values()), 'packet')} of {counted(len(rows), 'message')}{omitted}"

    def finish(self) -> list[Path]:
        """Complete the file; see `ExportWriter.finish`."""
        return [self._file.complete()]

    def discard(self) -> None:
        """Remove an incomplete file; see `ExportWriter.discard`."""
        self._file.discard()


class ReceiveClock:
    """The recorded times of packets.

    Args:
        start: Time of packets before the first recorded time, in microseconds since 1970.
    """

    def __init__(self, start: int) -> None:
        self._time = start

    def time_of(self, packet: Packet) -> int:
        """Return the time of the next packet in microseconds since 1970."""
        if packet.timestamp is not None and packet.timestamp <= _MAX_TIME:
            self._time = packet.timestamp
        return self._time


class StreamClock:
    """The times of packets without times, by the clock of the first system whose messages have one.

    Args:
        offset_us: UTC minus time since boot in microseconds; 0 if it is not known.
    """

    def __init__(self, offset_us: int) -> None:
        self._offset = offset_us
        self._system: int | None = None
        self._time = offset_us

    def time_of(self, packet: Packet) -> int:
        """Return the time of the next packet in microseconds since 1970, which is never before the last."""
        boot = _boot_microseconds(packet)
        if boot is not None and self._system in (None, packet.system):
            self._system = packet.system
            if boot + self._offset < self._time:
                # After a reboot the vehicle's clock restarts, but the time of the log continues.
                self._offset = self._time - boot
            self._time = boot + self._offset
        return min(max(self._time, 0), _MAX_TIME)


def _boot_microseconds(packet: Packet) -> int | None:
    """Return the time since boot that a packet holds, or None."""
    for field, factor in _BOOT_FIELDS:
        value = getattr(packet.message, field, None)
        if isinstance(value, int) and 0 < value * factor < _MAX_BOOT_US:
            return value * factor
    return None


TLOG: Final = LogExporter("tlog", "tlog, for logs of packets", ".tlog", False, TlogWriter)
