"""A capture as a log of packets: those of all flows in the order of arrival, with the times of frames."""

from __future__ import annotations

from operator import itemgetter
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Final

from mavstack.logs.damage import LogDamage
from mavstack.logs.log import DEFAULT_WINDOW
from mavstack.logs.log_bytes import LogBytes
from mavstack.logs.packets.packet_log import PacketLog
from mavstack.logs.packets.pcap.datagrams import read_segment
from mavstack.logs.packets.pcap.flows import Flows
from mavstack.logs.packets.pcap.frames import CaptureDamage, read_frames

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from mavstack.dialects import Dialect
    from mavstack.logs.message_table import MessageTable
    from mavstack.logs.packets.pcap.flows import Flow, FlowKey
    from mavstack.wire import Packet


#: Marks a time that a tlog cannot hold; `_time` is NaT.
_UNKNOWN_TIME: Final = 2**64 - 1


class CaptureLog(PacketLog):
    """A capture of network traffic (pcap or pcapng) as a log of packets.

    The payloads of each direction of each UDP or TCP connection are parsed by a parser of their own. `_time`
    is the time of the frame that completed the packet. The packets of the capture are kept in memory.

    Args:
        source: Path of the file, or its bytes.
        dialect: The dialect of the messages.
        threads: Maximum number of threads; 0 for one per processor.

    Raises:
        LogError: The file cannot be read.
    """

    def __init__(
        self, source: str | os.PathLike[str] | LogBytes, dialect: Dialect, *, threads: int = 0
    ) -> None:
        file = source if isinstance(source, LogBytes) else LogBytes(Path(source))
        self._damage, self._other_frames = CaptureDamage(), 0
        self._flows = Flows(dialect)
        packets = CapturedPackets(file.path, self._tlog(file))
        super().__init__(packets, dialect, timestamped=True, threads=threads)
        self.size = file.size
        self.format = "pcap"

    def _tlog(self, file: LogBytes) -> bytes:
        """Return the packets of the flows with MAVLink as a tlog."""
        found: list[tuple[FlowKey, int, Packet]] = []
        with file.access() as data:
            for frame in read_frames(data, self._damage):
                segment = read_segment(frame.link_type, frame.data)
                if segment is None:
                    self._other_frames += 1
                else:
                    found += self._flows.receive(segment, _tlog_time(frame.time))
        found += self._flows.finish()
        kept = [(time, packet.raw) for key, time, packet in found if self._flows.by_key[key].known_packets]
        # TCP segments that waited for a missing segment are returned late.
        kept.sort(key=itemgetter(0))
        return b"".join(time.to_bytes(8, "big") + raw for time, raw in kept)

    @property
    def flows(self) -> Mapping[FlowKey, Flow]:
        """The directions of connections that hold packets of known messages."""
        return {key: flow for key, flow in self._flows.by_key.items() if flow.known_packets}

    @property
    def skipped(self) -> LogDamage:
        """Damage of the file, bytes outside of packets in flows of MAVLink, and frames of other protocols."""
        flows = self.flows
        statistics = [flow.parser.statistics for flow in flows.values()]
        others = sum(flow.payload_bytes for key, flow in self._flows.by_key.items() if key not in flows)
        other = {
            "frames without UDP or TCP": self._other_frames,
            "bytes of other protocols": others,
            "bytes that the capture misses": sum(flow.lost_bytes for flow in flows.values()),
        }
        return LogDamage(
            bad_bytes=self._damage.bad_bytes + sum(totals.bad_bytes for totals in statistics),
            truncated_bytes=self._damage.truncated_bytes,
            unknown=self.unknown,
            other={reason: count for reason, count in other.items() if count},
        )

    def windows(
        self,
        size: int = DEFAULT_WINDOW,
        names: Sequence[str] | None = None,
        *,
        progress: Callable[[int, int], None] | None = None,
    ) -> Iterator[dict[str, MessageTable]]:
        """Yield the packets piece by piece; see `Log.windows`."""
        whole = max(self._bytes.size, 1)

        def report(done: int, _size: int) -> None:
            if progress is not None:
                progress(self.size * done // whole if done < self._bytes.size else self.size, self.size)

        yield from super().windows(size, names, progress=report)


class CapturedPackets(LogBytes):
    """The packets of a capture as the bytes of a tlog.

    Args:
        path: Path of the capture.
        content: The packets.
    """

    def __init__(self, path: Path, content: bytes) -> None:
        self.path, self.size = path, len(content)
        self._lock = Lock()
        self._copy = content
        self._map = self._guard = None

    def read_into(self, offset: int, buffer: memoryview) -> None:
        """Copy bytes into a buffer; see `LogBytes.read_into`."""
        buffer[:] = self.read(offset, len(buffer))

    def read(self, offset: int, size: int) -> bytes:
        """Return bytes, up to the end; see `LogBytes.read`."""
        return bytes((self._copy or b"")[offset : offset + size])


def _tlog_time(time: int | None) -> int:
    return _UNKNOWN_TIME if time is None or not 0 <= time < _UNKNOWN_TIME else time
