"""`mav data convert --to mcap --profile ros2`: the topics of ROS 2 from any log.

A log of packets is converted as if the bridge had been there. A log that the vehicle wrote itself becomes the
messages that a vehicle with such values sends (`mavstack.logs.replay`), and these become topics.
"""

from __future__ import annotations

from collections import Counter
from typing import IO, TYPE_CHECKING, Final

from mavstack.bridges.core.bridge import DEFAULT_NAME
from mavstack.bridges.core.names import VehicleNames
from mavstack.bridges.core.vehicle_bridge import RADIO_SYSTEM
from mavstack.bridges.mcap.log_topics import LogTopics
from mavstack.bridges.mcap.writer import Ros2Mcap
from mavstack.dialects import Dialect, common
from mavstack.errors import MissingExtraError
from mavstack.logs.export import ExportOptions, LogExporter
from mavstack.logs.export.writer import ExportWriter, PartFile, counted, nothing_to_write
from mavstack.logs.replay import replay_records
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from mavstack.bridges.core.topic import Topic
    from mavstack.logs.export.writer import Progress
    from mavstack.logs.log import Log
    from mavstack.wire import Packet

_TIME_SIZE: Final = 8
_NO_AUTOPILOT: Final = int(common.MavAutopilot.INVALID)
#: Packets between two calls of `progress`.
_PROGRESS_STEP: Final = 1 << 12
#: Maximum number of vehicles of one log; further vehicles are left out.
MAX_VEHICLES: Final = 250


class Ros2Writer(ExportWriter):
    """Writes the topics of a log into an MCAP file."""

    def __init__(self, log: Log, path: Path, options: ExportOptions) -> None:
        super().__init__(log, path, options)
        self._part = PartFile(path)
        self._stream: IO[bytes] = self._part.temporary.open("wb")
        try:
            self._file = Ros2Mcap(self._stream)
        except MissingExtraError:
            self.discard()
            raise
        self._rows: Counter[str] = Counter()
        self._vehicles: dict[int, LogTopics] = {}

    def write_log(self, names: Sequence[str], progress: Progress) -> Mapping[str, int]:
        """Write the samples; see `ExportWriter.write_log`."""
        parser, wanted, done = Parser(Dialect.load("all")), set(names), 0
        for number, record in enumerate(replay_records(self.log)):
            time = int.from_bytes(record[:_TIME_SIZE], "big") * 1000
            for packet in parser.feed(record[_TIME_SIZE:]):
                if not wanted or packet.name in wanted:
                    self._receive(packet, time)
            done += len(record)
            if progress is not None and not number % _PROGRESS_STEP:
                progress(min(done, self.log.size), self.log.size)
        if not self._rows:
            raise nothing_to_write(self.log)
        if progress is not None:
            progress(self.log.size, self.log.size)
        return self._rows

    def describe(self, rows: Mapping[str, int]) -> str:
        """Return the number of samples; see `ExportWriter.describe`."""
        return f"{counted(sum(rows.values()), 'sample')} of {counted(len(rows), 'topic')}"

    def finish(self) -> list[Path]:
        """Complete the file; see `ExportWriter.finish`."""
        self._file.finish()
        self._stream.close()
        return [self._part.complete()]

    def discard(self) -> None:
        """Remove an incomplete file; see `ExportWriter.discard`."""
        self._stream.close()
        self._part.discard()

    def _receive(self, packet: Packet, time: int) -> None:
        if packet.system == RADIO_SYSTEM and packet.system not in self._vehicles:
            for each in self._vehicles.values():
                each.receive(packet, time)
            return
        vehicle = self._vehicles.get(packet.system)
        if vehicle is None and self._is_vehicle(packet):
            vehicle = self._vehicles[packet.system] = LogTopics(
                packet.system, self._names(packet), self._write
            )
        if vehicle is not None:
            vehicle.receive(packet, time)

    def _is_vehicle(self, packet: Packet) -> bool:
        message = packet.message
        is_autopilot = isinstance(message, common.Heartbeat) and message.autopilot != _NO_AUTOPILOT
        return is_autopilot and len(self._vehicles) < MAX_VEHICLES

    def _names(self, packet: Packet) -> VehicleNames:
        """Return the names of a vehicle, as the bridge gives them: the first one has no prefix."""
        return VehicleNames(f"/{DEFAULT_NAME}{packet.system}" if self._vehicles else "")

    def _write(self, topic: Topic, payload: bytes, stamp: int, time: int) -> None:
        self._rows[topic.name] += 1
        self._file.add(topic, payload, time, stamp)


ROS2_MCAP: Final = LogExporter("mcap", "MCAP with the topics of ROS 2, one file", ".mcap", False, Ros2Writer)
