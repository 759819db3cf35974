"""The flight book: a row for each vehicle in each log below a folder, or below several.

A log is read once; it is read again when its size or its time of change differs. Logs that were removed leave
the book. The remarks that a pilot writes into `incidents` stay. A log is named by its path from the folder of
the book, so that both can be moved together, or by its whole path if it is elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack.errors import InvalidArgumentError, LogError, MavstackError, MissingExtraError
from mavstack.logs.analysis import analyse, flights
from mavstack.logs.export.csv_text import sql_of_column
from mavstack.logs.opening import open_log
from mavstack.logs.report.report import flight_facts

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterator, Sequence
    from types import TracebackType
    from typing import Self

    from mavstack.logs.analysis import Flight

#: Suffixes of the files that are opened; the format follows from the content.
SUFFIXES: Final = frozenset(
    {".tlog", ".bin", ".log", ".ulg", ".bbl", ".bfl", ".mavlink", ".raw", ".pcap", ".pcapng"}
)
#: Columns of the book and their types in SQL; lengths in m, times in s, positions in degrees.
COLUMNS: Final = {
    "file": "VARCHAR",
    "vehicle": "INTEGER",
    "vehicle_type": "VARCHAR",
    "date": "DATE",
    "start": "TIMESTAMP",
    "duration_s": "DOUBLE",
    "flight_time_s": "DOUBLE",
    "takeoffs": "INTEGER",
    "first_takeoff_s": "DOUBLE",
    "last_landing_s": "DOUBLE",
    "first_latitude": "DOUBLE",
    "first_longitude": "DOUBLE",
    "last_latitude": "DOUBLE",
    "last_longitude": "DOUBLE",
    "distance_m": "DOUBLE",
    "max_altitude_m": "DOUBLE",
    "max_ground_speed_m_s": "DOUBLE",
    "used_mah": "DOUBLE",
    "findings": "VARCHAR",
    "skipped": "VARCHAR",
    "incidents": "VARCHAR",
}
_FACTS: Final = ("takeoffs", "distance_m", "max_altitude_m", "max_ground_speed_m_s", "used_mah")


@dataclass
class BookUpdate:
    """The result of an update: files that were read, unchanged, removed, or failed with their problem.

    `skipped` tells of the files that were read what they hold that could not be read.
    """

    read: int = 0
    unchanged: int = 0
    removed: int = 0
    failed: dict[str, str] = field(default_factory=dict)
    skipped: dict[str, str] = field(default_factory=dict)


class FlightBook:
    """A flight book, open; a context manager that closes it.

    Args:
        path: Path of the DuckDB file, which is made if it does not exist.

    Raises:
        MissingExtraError: DuckDB is not installed.
        LogError: The file cannot be opened, or is no flight book.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        try:
            self._duckdb: Any = import_module("duckdb")
        except ImportError:
            raise MissingExtraError("the flight book", "data") from None
        self.path = Path(path)
        columns = ", ".join(f"{name} {kind}" for name, kind in COLUMNS.items())
        try:
            self._connection = self._duckdb.connect(str(path))
            self._connection.execute(
                "CREATE TABLE IF NOT EXISTS files (path VARCHAR, size BIGINT, changed BIGINT)"
            )
            self._connection.execute(f"CREATE TABLE IF NOT EXISTS flights ({columns})")
            self._add_columns()
            self._connection.execute("CREATE TABLE IF NOT EXISTS book (folder VARCHAR)")
            self._is_settled = self._settle()
        except self._duckdb.Error as error:
            reason = str(error).splitlines()[0]
            raise LogError(f"cannot open the flight book {path}: {reason}") from error

    def update(
        self, folder: str | os.PathLike[str], progress: Callable[[int, int], None] | None = None
    ) -> BookUpdate:
        """Read the logs below a folder that are new or changed; logs elsewhere stay in the book.

        Args:
            folder: The folder.
            progress: Called with the number of files that were looked at, and with that of all.

        Returns:
            Counts of files, and those that cannot be read.

        Raises:
            LogError: The folder cannot be read.

        A log that was removed from the folder leaves the book. The logs of a book that was moved to another
        folder without them keep their rows.
        """
        root = Path(folder)
        if not root.is_dir():
            raise LogError(f"{root}: it is not a folder")
        files = sorted(path for path in root.rglob("*") if path.suffix.lower() in SUFFIXES and path.is_file())
        result = BookUpdate()
        known = {name: state for name, state in self._known() if self._is_below(name, root)}
        for done, path in enumerate(files, 1):
            name = self._name_of(root.resolve() / path.relative_to(root))
            before = known.pop(name, None)
            try:
                status = path.stat()
            except OSError as error:  # the file was removed in the meantime
                result.failed[name] = f"cannot open {path}: {error.strerror}"
                continue
            state = status.st_size, status.st_mtime_ns
            if before == state:
                result.unchanged += 1
            else:
                self._read(path, name, state, result)
            if progress is not None:
                progress(done, len(files))
        for name in known if self._is_settled else ():
            self._forget(name)
            result.removed += 1
        self._is_settled = True
        return result

    def rows(self) -> list[dict[str, Any]]:
        """Return the flights, the oldest first."""
        table = self._connection.table("flights").order("start NULLS LAST, file, vehicle")
        return [dict(zip(COLUMNS, row, strict=True)) for row in table.select(*COLUMNS).fetchall()]

    def add_incident(self, file: str, text: str) -> int:
        """Write a remark about the flights of a log.

        Args:
            file: Path of the log as in the book, or the end of it.
            text: The remark; it replaces an earlier one.

        Returns:
            Number of flights with the remark.

        Raises:
            InvalidArgumentError: Several logs in the book have such a path.
        """
        names = [name for (name,) in self._connection.execute("SELECT DISTINCT file FROM flights").fetchall()]
        found = [name for name in names if name == file] or [name for name in names if _ends_with(name, file)]
        if len(found) > 1:
            raise InvalidArgumentError(f"{file} names several logs of the book: {', '.join(sorted(found))}")
        for name in found:
            self._connection.execute("UPDATE flights SET incidents = ? WHERE file = ?", [text, name])
        return sum(row["file"] in found for row in self.rows())

    def export_csv(self, path: str | os.PathLike[str], *, raw_text: bool = False) -> None:
        """Write the book as CSV.

        Args:
            path: Path of the file.
            raw_text: True keeps texts that spreadsheets run as formulas; False writes an apostrophe before
                them.

        Raises:
            LogError: The file cannot be written.
        """
        try:
            rows = self._connection.table("flights").order("start, file, vehicle")
            texts = [] if raw_text else [name for name, kind in COLUMNS.items() if "VARCHAR" in kind]
            columns = [sql_of_column(name) if name in texts else name for name in COLUMNS]
            rows.project(", ".join(columns)).write_csv(str(path))
        except self._duckdb.Error as error:
            raise LogError(f"cannot write {path}: {str(error).splitlines()[0]}") from error

    def close(self) -> None:
        """Close the file. Idempotent."""
        self._connection.close()

    def _add_columns(self) -> None:
        """Give a book of an earlier version the columns that it lacks; its logs are read again."""
        known = {row[0] for row in self._connection.execute("DESCRIBE flights").fetchall()}
        missing = [name for name in COLUMNS if name not in known]
        for name in missing:
            self._connection.execute(f"ALTER TABLE flights ADD COLUMN {name} {COLUMNS[name]}")
        if missing:
            self._connection.execute("DELETE FROM files")

    def _settle(self) -> bool:
        """Name the logs of a book that was moved without them by their whole paths.

        Returns:
            False if the book does not record the folder of its names, as those of earlier versions.
        """
        folder = self.path.resolve().parent
        recorded = self._connection.execute("SELECT folder FROM book").fetchone()
        relative = [name for name, _ in self._known() if not Path(name).is_absolute()]
        if recorded is not None and recorded[0] != str(folder):
            for name in relative:
                if not (folder / name).exists():
                    self._rename(name, str(Path(recorded[0]) / name))
        self._connection.execute("DELETE FROM book")
        self._connection.execute("INSERT INTO book VALUES (?)", [str(folder)])
        return recorded is not None or not relative

    def _rename(self, name: str, new: str) -> None:
        self._connection.execute("UPDATE files SET path = ? WHERE path = ?", [new, name])
        self._connection.execute("UPDATE flights SET file = ? WHERE file = ?", [new, name])

    def _known(self) -> Iterator[tuple[str, tuple[int, int]]]:
        for path, size, changed in self._connection.execute("SELECT * FROM files").fetchall():
            yield path, (size, changed)

    def _name_of(self, path: Path) -> str:
        """Return the name of a log in the book."""
        folder = self.path.resolve().parent
        return str(path.relative_to(folder) if path.is_relative_to(folder) else path)

    def _is_below(self, name: str, root: Path) -> bool:
        return (self.path.resolve().parent / name).is_relative_to(root.resolve())

    def _read(self, path: Path, name: str, state: tuple[int, int], result: BookUpdate) -> None:
        try:
            with open_log(path) as log:
                if not len(log):
                    raise LogError(f"{path} contains no records")
                skipped = log.skipped.describe() if log.skipped else ""
                rows = [_row(name, flight, skipped) for flight in flights(log)]
        except (MavstackError, OSError) as error:
            result.failed[name] = str(error)
            return
        # One transaction, so that an interrupted run does not lose the remarks.
        self._connection.begin()
        try:
            self._replace(name, state, rows)
        except BaseException:
            self._connection.rollback()
            raise
        self._connection.commit()
        result.read += 1
        if skipped:
            result.skipped[name] = skipped

    def _replace(self, name: str, state: tuple[int, int], rows: Sequence[Sequence[object]]) -> None:
        """Replace the flights of a log; the remarks stay."""
        remarks = self._connection.execute(
            "SELECT any_value(incidents) FROM flights WHERE file = ?", [name]
        ).fetchone()
        self._forget(name)
        marks = ", ".join("?" * len(COLUMNS))
        names = ", ".join(COLUMNS)
        insert = f"INSERT INTO flights ({names}) VALUES ({marks})"  # noqa: S608 (only names and marks)
        for row in rows:
            self._connection.execute(insert, [*row, remarks[0] or ""])
        self._connection.execute("INSERT INTO files VALUES (?, ?, ?)", [name, *state])

    def _forget(self, name: str) -> None:
        self._connection.execute("DELETE FROM flights WHERE file = ?", [name])
        self._connection.execute("DELETE FROM files WHERE path = ?", [name])

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _row(name: str, flight: Flight, skipped: str) -> list[object]:
    """Return the values of a flight in the order of the columns, without the remarks."""
    facts = flight_facts(flight)
    start = flight.log.start
    known = start is not None and not np.isnat(start)
    armed = flight.armed_spans
    return [
        name,
        flight.system,
        flight.vehicle_type,
        str(start.astype("M8[D]")) if start is not None and known else None,
        str(start) if known else None,
        round(flight.duration, 3),
        facts.get("armed_s"),
        int(facts.get("takeoffs", 0)),
        armed[0][0] if armed else None,
        armed[-1][1] if armed else None,
        *_positions(flight),
        *(facts.get(key) for key in _FACTS[1:]),
        "; ".join(finding.title for finding in analyse(flight)),
        skipped,
    ]


def _ends_with(name: str, end: str) -> bool:
    """Return whether a path ends with the parts of another path."""
    parts = Path(end).parts
    return bool(parts) and Path(name).parts[-len(parts) :] == parts


def _positions(flight: Flight) -> Sequence[float | None]:
    track = flight.track
    if track is None or not len(track):
        return [None] * 4
    ends = ((track.latitudes[index], track.longitudes[index]) for index in (0, -1))
    return [float(value) for pair in ends for value in pair]
