"""Paths of ArduPilot's logs.

Logs are numbered from 1 to 500 and then from 1 again; LASTLOG.TXT in the same directory has the last number.
"""

from __future__ import annotations

import re
from contextlib import suppress
from typing import TYPE_CHECKING

from mavstack.sim.storage.dataflash import DataflashWriter
from mavstack.sim.storage.flight_logs import MAX_LOGS, FlightLogs, make_directories, write_file

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.services.ftp import Entry
    from mavstack.sim.storage.flight_logs import LogWriter
    from mavstack.sim.storage.sample import LogStart


class DataflashLogs(FlightLogs):
    """ArduPilot's logs: /APM/LOGS/00000001.BIN and so on; LASTLOG.TXT has the number of the last."""

    DIRECTORY = "/APM/LOGS"
    _NAME = re.compile(r"0*([1-9]\d{0,4})\.BIN", re.ASCII | re.IGNORECASE)

    def _new_path(self, time: int) -> str:
        number = self._last_number() % MAX_LOGS + 1
        make_directories(self._store, self.DIRECTORY)
        write_file(self._store, f"{self.DIRECTORY}/LASTLOG.TXT", b"%u\r\n" % number)
        return f"{self.DIRECTORY}/{number:08}.BIN"

    def _new_writer(self, start: LogStart, time_us: int) -> LogWriter:
        return DataflashWriter(start, time_us)

    def _existing_logs(self) -> dict[int, tuple[str, Entry]]:
        found = {}
        for entry in self._list(self.DIRECTORY):
            name = self._NAME.fullmatch(entry.name)
            if name and not entry.is_directory and int(name[1]) <= MAX_LOGS:
                found[int(name[1])] = (f"{self.DIRECTORY}/{entry.name}", entry)
        return found

    def _time_of(self, path: str, entry: Entry) -> int:
        return self._times.get(path, entry.modified)

    def _oldest_first(self, numbers: Iterable[int]) -> list[int]:
        last = self._last_number()
        return sorted(numbers, key=lambda number: (number - last - 1) % MAX_LOGS)

    def _last_number(self) -> int:
        """Return the number of the last log."""
        try:
            file = self._store.open_file(f"{self.DIRECTORY}/LASTLOG.TXT")
        except OSError:
            return max(self._existing_logs(), default=0)
        try:
            number = file.read(0, 8).split()[:1]
        except OSError:
            number = []
        file.close()
        return int(number[0]) if number and number[0].isdigit() else max(self._existing_logs(), default=0)

    def _clear_index(self) -> None:
        with suppress(OSError):
            self._store.remove(f"{self.DIRECTORY}/LASTLOG.TXT")
