"""The files of the logs on a vehicle, and their names on this machine.

MAVLink FTP is many times faster than LOG_DATA with its 90 bytes per message, and it resumes an interrupted
download. The list of logs has no paths, so the file of a log is the one with its size. If several files have
that size, or none as for the log that is being written, the log is downloaded by its number.
"""

from __future__ import annotations

from collections import Counter
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.cli.common.errors import CommandError
from mavstack.cli.ftp.paths import RemotePath, walk
from mavstack.dialects import common
from mavstack.errors import RemoteError
from mavstack.services.ftp import Entry

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.cli.ftp.limited import LimitedFtp
    from mavstack.services.log import LogEntry
    from mavstack.vehicle import Vehicle


class LogLocation(NamedTuple):
    """The directory of the logs on a vehicle, and the suffix of their names."""

    directory: str
    suffix: str


ARDUPILOT_LOGS: Final = LogLocation("/APM/LOGS", ".BIN")
PX4_LOGS: Final = LogLocation("/fs/microsd/log", ".ulg")
#: Unix time of the year 2000: an earlier start time comes from a clock that was not set.
_MIN_TIME: Final = 946_684_800


def log_location(vehicle: Vehicle) -> LogLocation:
    """Return the location of the logs on a vehicle."""
    info = vehicle.component.info
    px4 = info is not None and info.autopilot == common.MavAutopilot.PX4
    return PX4_LOGS if px4 else ARDUPILOT_LOGS


async def log_files(vehicle: Vehicle, ftp: LimitedFtp) -> list[RemotePath]:
    """List the files of the logs on a vehicle; empty if it refuses."""
    directory, suffix = log_location(vehicle)
    top = RemotePath(directory, Entry(directory, is_directory=True))
    try:
        return [each async for each in walk(ftp, top) if each.path.lower().endswith(suffix.lower())]
    except (RemoteError, CommandError):
        return []


def match_files(logs: Sequence[LogEntry], files: Sequence[RemotePath]) -> dict[int, RemotePath]:
    """Return the file of each log by its id, for the logs whose size is unique."""
    by_size = {each.entry.size: each for each in files}
    of_files = Counter(each.entry.size for each in files)
    of_logs = Counter(log.size for log in logs)
    return {
        log.id: by_size[log.size]
        for log in logs
        if log.size > 0 and of_files[log.size] == 1 and of_logs[log.size] == 1
    }


def time_text(log: LogEntry) -> str:
    """Return the start time of a log (UTC), or an empty text if the vehicle did not know it."""
    return f"{datetime.fromtimestamp(log.time_utc, UTC):%Y-%m-%d %H:%M:%S}" if _has_time(log) else ""


def local_file_name(log: LogEntry, suffix: str) -> str:
    """Return the local name of a log: 00000012.BIN of ArduPilot, log_12_2026-11-21_10-51-21.ulg of PX4."""
    if suffix == ARDUPILOT_LOGS.suffix:
        return f"{log.id:08d}{suffix}"
    time = f"_{datetime.fromtimestamp(log.time_utc, UTC):%Y-%m-%d_%H-%M-%S}" if _has_time(log) else ""
    return f"log_{log.id}{time}{suffix}"


def _has_time(log: LogEntry) -> bool:
    return log.time_utc >= _MIN_TIME
