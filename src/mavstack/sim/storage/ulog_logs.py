"""Paths of PX4's logs: by day and start time. Ids are assigned in order, from 0."""

from __future__ import annotations

import re
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from mavstack.sim.storage.flight_logs import DEFAULT_LOG_CAPACITY, MAX_TIME, FlightLogs, make_directories
from mavstack.sim.storage.ulog import UlogWriter

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.ftp import Entry, FileStore
    from mavstack.sim.storage.flight_logs import LogWriter
    from mavstack.sim.storage.sample import LogStart


class UlogLogs(FlightLogs):
    """PX4's logs: /fs/microsd/log/2023-11-14/22_13_20.ulg, by start time."""

    DIRECTORY = "/fs/microsd/log"
    _DAY = re.compile(r"\d{4}-\d\d-\d\d", re.ASCII)
    _NAME = re.compile(r"\d\d_\d\d_\d\d\.ulg", re.ASCII)

    def __init__(
        self, store: FileStore, start: Callable[[], LogStart], *, capacity: int = DEFAULT_LOG_CAPACITY
    ) -> None:
        super().__init__(store, start, capacity=capacity)
        self._ids: dict[str, int] = {}

    def _new_path(self, time: int) -> str:
        taken = {path for path, _ in self._existing_logs().values()}
        while (path := self._path_at(time)) in taken:
            time += 1
        make_directories(self._store, path.rpartition("/")[0])
        return path

    def _new_writer(self, start: LogStart, time_us: int) -> LogWriter:
        return UlogWriter(start, time_us)

    def _existing_logs(self) -> dict[int, tuple[str, Entry]]:
        days = [day.name for day in self._list(self.DIRECTORY) if self._DAY.fullmatch(day.name)]
        files = {
            f"{self.DIRECTORY}/{day}/{entry.name}": entry
            for day in days
            for entry in self._list(f"{self.DIRECTORY}/{day}")
            if self._NAME.fullmatch(entry.name) and not entry.is_directory
        }
        following = max(self._ids.values(), default=-1) + 1
        new = sorted(path for path in files if path not in self._ids)
        self._ids = {path: number for path, number in self._ids.items() if path in files}
        self._ids.update((path, following + place) for place, path in enumerate(new))
        return {number: (path, files[path]) for path, number in self._ids.items()}

    def _time_of(self, path: str, entry: Entry) -> int:
        day, _, name = path.removeprefix(self.DIRECTORY + "/").partition("/")
        try:
            moment = datetime.strptime(f"{day} {name} +0000", "%Y-%m-%d %H_%M_%S.ulg %z")
        except ValueError:
            return entry.modified
        return int(moment.timestamp())

    def _clear_index(self) -> None:
        self._ids.clear()

    def _path_at(self, time: int) -> str:
        """Return the path of a log that starts at a Unix time."""
        moment = datetime.fromtimestamp(min(time, MAX_TIME), UTC)
        return f"{self.DIRECTORY}/{moment:%Y-%m-%d/%H_%M_%S}.ulg"
