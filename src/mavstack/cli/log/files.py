"""The logs on a vehicle as files: which file a log of the list is, and what it is called here.

MAVLink FTP brings a file many times faster than LOG_DATA does its ninety bytes at a time, and takes up again
what broke off. The list of logs tells no paths, so a log is the file that has its size; where several have,
or none, as for the log that is being written, it is fetched by its number.
"""

from __future__ import annotations

from collections import Counter
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from mavstack.cli.ftp.paths import Found, walk
from mavstack.dialects import common
from mavstack.errors import RemoteError
from mavstack.services.ftp import Entry

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.services.log import LogEntry
    from mavstack.vehicle import Vehicle

ARDUPILOT_LOGS, PX4_LOGS = ("/APM/LOGS", ".BIN"), ("/fs/microsd/log", ".ulg")
_FIRST_TIME = 946_684_800  # before the year 2000 no clock was set


def place_of(vehicle: Vehicle) -> tuple[str, str]:
    """Where the logs of a vehicle lie, and the suffix of their names."""
    info = vehicle.component.info
    px4 = info is not None and info.autopilot == common.MavAutopilot.PX4
    return PX4_LOGS if px4 else ARDUPILOT_LOGS


async def files_of(vehicle: Vehicle) -> list[Found]:
    """The files of logs on a vehicle; none if it does not tell."""
    directory, suffix = place_of(vehicle)
    top = Found(directory, Entry(directory, is_directory=True))
    try:
        return [each async for each in walk(vehicle.ftp, top) if each.path.lower().endswith(suffix.lower())]
    except RemoteError:
        return []


def match(logs: Sequence[LogEntry], files: Sequence[Found]) -> dict[int, Found]:
    """The file of each log, by its id, where there is no doubt."""
    by_size = {each.entry.size: each for each in files}
    of_files = Counter(each.entry.size for each in files)
    of_logs = Counter(log.size for log in logs)
    return {
        log.id: by_size[log.size]
        for log in logs
        if log.size > 0 and of_files[log.size] == 1 and of_logs[log.size] == 1
    }


def time_text(log: LogEntry) -> str:
    """When a log began, or nothing if the vehicle did not know."""
    return f"{datetime.fromtimestamp(log.time_utc, UTC):%Y-%m-%d %H:%M:%S}" if _has_time(log) else ""


def name_for(log: LogEntry, suffix: str) -> str:
    """What a log is called here: 00000012.BIN as ArduPilot does, log_12_2026-11-21_10-51-21.ulg for PX4."""
    if suffix == ARDUPILOT_LOGS[1]:
        return f"{log.id:08d}{suffix}"
    when = f"_{datetime.fromtimestamp(log.time_utc, UTC):%Y-%m-%d_%H-%M-%S}" if _has_time(log) else ""
    return f"log_{log.id}{when}{suffix}"


def _has_time(log: LogEntry) -> bool:
    return log.time_utc >= _FIRST_TIME
