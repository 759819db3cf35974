"""Blackbox logs: tables MAIN, SLOW, GPS, HOME and EVENT, with the flights of a file in one table.

The file of a flash chip holds all flights since it was erased. Each begins with its own header and has its
own number, in the column `_instance`; flights whose frames have other fields are in another table (`MAIN_2`).

Opening a file reads the headers; the flights are decoded when a table is first needed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import LogError
from mavstack.logs.blackbox.events import event_text
from mavstack.logs.blackbox.fields import field_schema, flight_modes
from mavstack.logs.blackbox.flight import UNKNOWN_TIME, FlightDecoder
from mavstack.logs.blackbox.frames import UnsupportedFieldError
from mavstack.logs.blackbox.header import FLIGHT_MARKER, read_header
from mavstack.logs.blackbox.tables import TIME, event_rows, table_rows
from mavstack.logs.damage import LogDamage
from mavstack.logs.log import Log
from mavstack.logs.log_bytes import LogBytes
from mavstack.logs.message_table import MessageTable
from mavstack.logs.records import LogText, ParameterChange, RowRecord
from mavstack.logs.schema import SchemaSource, TableSchema
from mavstack.logs.time_base import TimeBase
from mavstack.logs.vehicles import LogVehicle

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from mavstack.logs.blackbox.header import FlightHeader
    from mavstack.logs.records import LogRecord
    from mavstack.logs.time_base import Clock

_MAX_FLIGHTS: Final = 1000
_TABLES: Final = {"S": "SLOW", "G": "GPS", "H": "HOME"}
_MAIN, _EVENT = "MAIN", "EVENT"
_INFO: Final = {
    "firmware_version": "Firmware revision",
    "firmware_type": "Firmware type",
    "firmware_date": "Firmware date",
    "hardware": "Board information",
    "craft": "Craft name",
    "start": "Log start datetime",
}


@dataclass(frozen=True)
class _Flight:
    """A flight: its number, its position in the file, its header and its tables by name."""

    number: int
    start: int
    size: int
    header: FlightHeader
    tables: Mapping[str, NDArray[np.void]]
    positions: Mapping[str, NDArray[np.int64]]
    damage: LogDamage
    offset_us: int | None

    @property
    def span(self) -> tuple[int, int] | None:
        """Earliest and latest time in microseconds since boot."""
        times = [table[TIME] for table in self.tables.values() if len(table)]
        if not times:
            return None
        return min(int(part.min()) for part in times), max(int(part.max()) for part in times)


class BlackboxLog(Log):
    """A Blackbox log.

    Args:
        source: Path of the file, or its bytes.

    Raises:
        LogError: The file cannot be read, or no flight has a complete header.
    """

    format = "blackbox"

    def __init__(self, source: str | os.PathLike[str] | LogBytes) -> None:
        self._bytes = source if isinstance(source, LogBytes) else LogBytes(Path(source))
        super().__init__(self._bytes.path, self._bytes.size)
        data = self._bytes.read(0, self.size)
        self._starts = _flight_starts(data)
        self._headers = [read_header(data[start:end]) for start, end in self._ranges()]
        if not any({"I", "P"} <= header.frames.keys() for header in self._headers):
            raise LogError(f"cannot open {self.path}: no flight in it has a complete header")
        self._schemas: dict[str, SchemaSource] = {}

    # flights

    @property
    def headers(self) -> list[Mapping[str, str]]:
        """The settings in the header of each flight, by name."""
        return [header.values for header in self._headers]

    @cached_property
    def _flights(self) -> list[_Flight]:
        data = self._bytes.read(0, self.size)
        parts = zip(self._ranges(), self._headers, strict=True)
        return [
            _decoded(number, start, data[start:end], header)
            for number, ((start, end), header) in enumerate(parts)
        ]

    def _ranges(self) -> list[tuple[int, int]]:
        """Return the beginning and the end of each flight."""
        return list(pairwise([*self._starts, self.size])) if self._starts else []

    @cached_property
    def _places(self) -> dict[str, list[tuple[_Flight, str]]]:
        """The tables that make up each table of the log; flights with other fields have separate tables."""
        places: dict[str, list[tuple[_Flight, str]]] = {}
        for flight in self._flights:
            for name, rows in flight.tables.items():
                key, number = name, 1
                while key in places and _dtype(places[key][0]) != rows.dtype:
                    number += 1
                    key = f"{name}_{number}"
                places.setdefault(key, []).append((flight, name))
        return places

    @cached_property
    def counts(self) -> Mapping[str, int]:
        """Number of rows by table name."""
        rows = {
            key: sum(len(flight.tables[name]) for flight, name in places)
            for key, places in self._places.items()
        }
        return {key: count for key, count in rows.items() if count}

    def decode_tables(self, names: Sequence[str]) -> Mapping[str, MessageTable]:
        """Return tables; see `Log.decode_tables`."""
        return {key: MessageTable.of(self._rows(key), self._schema_source(key)) for key in names}

    def _rows(self, key: str) -> NDArray[np.void]:
        return np.concatenate([flight.tables[name] for flight, name in self._places[key]])

    def records(self, *names: str) -> Iterator[LogRecord]:
        """Iterate over the frames in the order of the file; see `Log.records`."""
        wanted = [key for key in self if not names or key in names]
        order = [
            (int(position), key, row)
            for key in wanted
            for row, position in enumerate(
                np.concatenate([flight.positions[name] for flight, name in self._places[key]])
            )
        ]
        self.load(*wanted)
        for _, key, row in sorted(order):
            yield RowRecord(key, self[key].view(np.ndarray)[row])

    # the meaning of the columns

    def schema(self, name: str) -> TableSchema:
        """Return the meaning of the columns of a table; see `Log.schema`."""
        self._require([name])
        return self._schema_source(name).schema

    def _schema_source(self, key: str) -> SchemaSource:
        if key not in self._schemas:
            self._schemas[key] = SchemaSource(lambda: self._make_schema(key))
        return self._schemas[key]

    def _make_schema(self, key: str) -> TableSchema:
        flight, name = self._places[key][0]
        dtype = flight.tables[name].dtype
        fields = [field_schema(column, dtype[column], flight.header) for column in dtype.names or ()]
        return TableSchema(key, tuple(fields), instance_field="_instance", source="file")

    # time

    @property
    def clock(self) -> Clock:
        """The kind of the time base: "utc" if the clock was set in all flights."""
        return "boot" if any(flight.offset_us is None for flight in self._flights if flight.span) else "utc"

    def read_time_base(self, log: Log) -> TimeBase:
        """Return the clock of the flight controller, which the header relates to UTC if it was set."""
        offset = next((flight.offset_us for flight in self._flights if flight.offset_us is not None), None)
        return TimeBase(self.clock, offset, None, "" if offset is None else "header of the flight")

    @property
    def time_span(self) -> tuple[float, float] | None:
        """Earliest and latest time of a row in seconds, in UTC or since boot; None without rows."""
        is_utc = self.clock == "utc"
        spans = [
            tuple((time + (flight.offset_us or 0) * is_utc) / 1e6 for time in span)
            for flight in self._flights
            if (span := flight.span) is not None
        ]
        return (min(first for first, _ in spans), max(last for _, last in spans)) if spans else None

    def boot_times(self, name: str, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the field `time` of each row; see `Log.boot_times`."""
        names = table.dtype.names or ()
        return table[TIME] / 1e6 if TIME in names else None

    # facts

    def read_info(self, log: Log) -> dict[str, str]:
        """Return the facts in the header of the first flight, and the number of flights."""
        values = self._headers[0].values
        found = {name: values[key] for name, key in _INFO.items() if values.get(key)}
        return {"autopilot": self._headers[0].firmware[0], **found, "flights": str(len(self._headers))}

    def read_parameters(self, log: Log) -> tuple[dict[str, float], list[ParameterChange]]:
        """Return the numbers in the headers: all of the first flight, and the changes in later flights."""
        first = _numbers(self._headers[0])
        latest, changes = dict(first), []
        for flight in self._flights[1:]:
            time = 0 if flight.span is None else flight.span[0]
            for name, value in _numbers(flight.header).items():
                if latest.get(name) != value:
                    utc = _utc(time, flight.offset_us)
                    changes.append(ParameterChange(utc, name, latest.get(name), value, boot_us=time))
                latest[name] = value
        return first, changes

    def read_texts(self, log: Log) -> list[LogText]:
        """Return the events in words."""
        texts = []
        for flight in self._flights:
            modes = flight_modes(flight.header)
            for row in flight.tables.get(_EVENT, ()):
                text = event_text(int(row["event"]), float(row["value"]), modes)
                time = int(row[TIME])
                texts.append(LogText(_utc(time, flight.offset_us), 6, text, boot_us=time))
        return texts

    def read_vehicles(self, log: Log) -> dict[int, LogVehicle]:
        """Return the vehicle that wrote the log."""
        return {0: LogVehicle(0, 1, "", self._headers[0].firmware[0])}

    @cached_property
    def skipped(self) -> LogDamage:
        """Bytes outside of frames, damaged frames, and frames that damage before them made unreadable."""
        parts = [flight.damage for flight in self._flights]
        reasons = dict.fromkeys(reason for part in parts for reason in part.other)
        return LogDamage(
            bad_bytes=sum(part.bad_bytes for part in parts) + self._starts[0],
            bad_records=sum(part.bad_records for part in parts),
            other={reason: sum(part.other.get(reason, 0) for part in parts) for reason in reasons},
        )


def _dtype(place: tuple[_Flight, str]) -> np.dtype[np.void]:
    flight, name = place
    return flight.tables[name].dtype


def _flight_starts(data: bytes) -> list[int]:
    """Return the positions at which flights begin; the last flight has the rest of a file with very many."""
    starts: list[int] = []
    position = data.find(FLIGHT_MARKER)
    while position >= 0 and len(starts) < _MAX_FLIGHTS:
        starts.append(position)
        position = data.find(FLIGHT_MARKER, position + len(FLIGHT_MARKER))
    return starts


def _decoded(number: int, start: int, data: bytes, header: FlightHeader) -> _Flight:
    """Return a flight with its tables."""
    try:
        decoder = FlightDecoder(data, header)
    except UnsupportedFieldError:
        damage = LogDamage(bad_bytes=len(data), other={"flights with unusable headers": 1})
        return _Flight(number, start, len(data), header, {}, {}, damage, None)
    kinds = {_MAIN: ("I", decoder.main)} | {
        name: (letter, {"S": decoder.slow, "G": decoder.gps, "H": decoder.home}[letter])
        for letter, name in _TABLES.items()
        if letter in header.frames
    }
    tables = {name: table_rows(rows, header.frames[letter]) for name, (letter, rows) in kinds.items()}
    positions = {name: np.frombuffer(rows.positions, np.int64) + start for name, (_, rows) in kinds.items()}
    tables[_EVENT] = event_rows(decoder.events)
    positions[_EVENT] = np.array([position for *_, position in decoder.events], np.int64) + start
    first = int(tables[_MAIN][TIME][0]) if len(tables[_MAIN]) else 0
    offset = None if header.start_us is None or not len(tables[_MAIN]) else header.start_us - first
    for table in tables.values():
        table[TIME][table[TIME] == UNKNOWN_TIME] = first
        table["_instance"] = number
        table["_time"] = "NaT" if offset is None else (table[TIME] + offset).astype("M8[us]")
    return _Flight(number, start, len(data), header, tables, positions, _damage(decoder), offset)


def _damage(decoder: FlightDecoder) -> LogDamage:
    counts = decoder.damage
    other = {
        "frames out of sequence": counts.out_of_sequence,
        "positions without a home position": counts.without_home,
    }
    return LogDamage(
        bad_bytes=counts.bad_bytes,
        bad_records=counts.corrupt,
        other={reason: count for reason, count in other.items() if count},
    )


def _numbers(header: FlightHeader) -> dict[str, float]:
    """Return the numbers in a header by name; the numbers of a list as `name[0]` and so on."""
    found: dict[str, float] = {}
    for name, value in header.values.items():
        texts = value.split(",")
        try:
            numbers = [float(text) for text in texts]
        except ValueError:
            continue
        keys = [name] if len(numbers) == 1 else [f"{name}[{index}]" for index in range(len(numbers))]
        found |= dict(zip(keys, numbers, strict=True))
    return found


def _utc(time: int, offset_us: int | None) -> np.datetime64:
    return np.datetime64("NaT", "us") if offset_us is None else np.datetime64(time + offset_us, "us")
