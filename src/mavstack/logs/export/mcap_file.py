"""MCAP: one file with a channel for each message of each component, which Foxglove opens.

Messages are JSON with a JSON schema of their fields, with units in the descriptions. Positions and texts come
also as `foxglove.LocationFix` and `foxglove.Log`, which Foxglove's map and log panels show.
"""

from __future__ import annotations

import json
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack.errors import MissingExtraError
from mavstack.logs.export.flights import by_vehicle
from mavstack.logs.export.json_rows import joined, json_rows, json_values
from mavstack.logs.export.mcap_stream import McapStream
from mavstack.logs.export.registry import LogExporter
from mavstack.logs.export.writer import ExportOptions, PartFile, TableWriter
from mavstack.logs.tracks import tracks

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable
    from mavstack.logs.records import LogText
    from mavstack.logs.schema import FieldSchema, TableSchema

_NANOSECONDS: Final = 1_000_000_000
#: MCAP stores times as nanoseconds in 64 bits.
_MAX_MICROSECONDS: Final = (2**64 - 1) // 1000
#: Level of foxglove.Log by MAV_SEVERITY: 5 fatal, 4 error, 3 warning, 2 info, 1 debug.
_LEVELS: Final = (5, 5, 5, 4, 3, 2, 2, 1)
#: JSON types by NumPy kind; kinds that are not listed are integers.
_TYPES: Final = {"f": "number", "S": "string", "U": "string", "b": "boolean"}
_TIME_SCHEMA: Final = {
    "type": "object",
    "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}},
}
_LOCATION_SCHEMA: Final = {
    "title": "foxglove.LocationFix",
    "type": "object",
    "properties": {
        "timestamp": _TIME_SCHEMA,
        "frame_id": {"type": "string"},
        "latitude": {"type": "number"},
        "longitude": {"type": "number"},
        "altitude": {"type": "number"},
        "position_covariance": {"type": "array", "items": {"type": "number"}},
        "position_covariance_type": {"type": "integer"},
    },
}
_LOG_SCHEMA: Final = {
    "title": "foxglove.Log",
    "type": "object",
    "properties": {
        "timestamp": _TIME_SCHEMA,
        "level": {"type": "integer"},
        "message": {"type": "string"},
        "name": {"type": "string"},
        "file": {"type": "string"},
        "line": {"type": "integer"},
    },
}


class McapWriter(TableWriter):
    """Writes an MCAP file."""

    def __init__(self, log: Log, path: Path, options: ExportOptions) -> None:
        super().__init__(log, path, options)
        self._file = PartFile(path)
        self._opened = self._file.temporary.open("wb")
        try:
            self._mcap = McapStream(self._opened)
            import_module("pyarrow.compute")
        except ImportError:
            self.discard()
            raise MissingExtraError("the export to MCAP", "data") from None
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._start = log.time_span or (0.0, 0.0)

    def write(self, tables: Mapping[str, MessageTable]) -> None:
        """Write the next rows; see `TableWriter.write`."""
        for system, name, table in by_vehicle(self.log, tables):
            channel = self._channel(f"/{system}/{name}" if system else f"/{name}", name, table.schema)
            names = [field for field in table.dtype.names or () if field != "_time"]
            columns = {field: self._column(table, field) for field in names}
            times = self._nanoseconds(self.log.times_of(name, table))
            self._mcap.add_messages(channel, times, json_rows(columns))

    def finish(self) -> list[Path]:
        """Complete the file; see `ExportWriter.finish`."""
        self._write_locations()
        self._write_texts()
        self._mcap.add_metadata("mavstack", {"file": self.log.path.name, "format": self.log.format})
        self._mcap.finish()
        self._opened.close()
        return [self._file.complete()]

    def discard(self) -> None:
        """Remove an incomplete file; see `ExportWriter.discard`."""
        self._opened.close()
        self._file.discard()

    def _column(self, table: MessageTable, name: str) -> NDArray[Any]:
        if self.options.enums and table.schema[name].enum is not None:
            return table.enum_names(name)
        column = np.asarray(table[name])
        if self.options.scaled and column.dtype.kind in "iuf" and not name.startswith("_"):
            return table.scaled(name)
        return column

    def _nanoseconds(self, seconds: NDArray[np.float64]) -> NDArray[np.uint64]:
        """Return times in the format of MCAP; an unknown time becomes the time of the beginning."""
        known = np.where(np.isfinite(seconds), seconds, self._start[0])
        return _nanoseconds(np.rint(known * 1e6))

    def _channel(self, topic: str, name: str, schema: TableSchema) -> int:
        if topic not in self._channels:
            if name not in self._schemas:
                self._schemas[name] = self._schema(name, _json_schema(schema, self.options))
            self._channels[topic] = self._mcap.add_channel(topic, self._schemas[name])
        return self._channels[topic]

    def _schema(self, name: str, schema: Mapping[str, Any]) -> int:
        return self._mcap.add_schema(name, json.dumps(schema).encode())

    def _write_locations(self) -> None:
        found = tracks(self.log)
        schema = self._schema("foxglove.LocationFix", _LOCATION_SCHEMA) if found else 0
        for track in found:
            topic = f"/{track.system}/location" if track.system else "/location"
            columns: dict[str, NDArray[Any]] = {
                "latitude": track.latitudes,
                "longitude": track.longitudes,
                "altitude": track.altitudes,
                "position_covariance_type": np.zeros(len(track.times), np.uint8),
                "frame_id": np.full(len(track.times), ""),
            }
            self._add(self._mcap.add_channel(topic, schema), self._nanoseconds(track.times), columns)

    def _write_texts(self) -> None:
        texts = self.log.texts
        if not texts:
            return
        channel = self._mcap.add_channel("/log", self._schema("foxglove.Log", _LOG_SCHEMA))
        columns: dict[str, NDArray[Any]] = {
            "level": np.array([_LEVELS[min(max(text.severity, 0), 7)] for text in texts]),
            "message": np.array([text.text for text in texts], object),
            "name": np.array([str(text.system) for text in texts]),
            "file": np.full(len(texts), ""),
            "line": np.zeros(len(texts), np.uint8),
        }
        times = np.array([_microseconds(text) for text in texts], np.float64)
        self._add(channel, _nanoseconds(times), columns)

    def _add(self, channel: int, times: NDArray[np.uint64], columns: dict[str, NDArray[Any]]) -> None:
        """Add messages of one of Foxglove's own schemas, which have the time in them."""
        seconds, nanoseconds = (json_values(part) for part in np.divmod(times, np.uint64(_NANOSECONDS)))
        timestamp = joined(['{"sec": ', seconds, ', "nsec": ', nanoseconds, "}"])
        self._mcap.add_messages(channel, times, json_rows({"timestamp": timestamp, **columns}))


def _microseconds(text: LogText) -> int:
    return text.boot_us or 0 if np.isnat(text.time) else int(text.time.astype("M8[us]").astype(np.int64))


def _nanoseconds(microseconds: NDArray[np.float64]) -> NDArray[np.uint64]:
    """Return the nearest times that MCAP can hold; damaged records have any time."""
    within = np.clip(microseconds, 0, _MAX_MICROSECONDS).astype(np.uint64)
    return np.minimum(within, np.uint64(_MAX_MICROSECONDS)) * np.uint64(1000)


def _json_schema(schema: TableSchema, options: ExportOptions) -> dict[str, Any]:
    properties = {field.name: _property(field, options) for field in schema if field.name != "_time"}
    return {
        "title": schema.name,
        "description": schema.description,
        "type": "object",
        "properties": properties,
    }


def _property(field: FieldSchema, options: ExportOptions) -> dict[str, Any]:
    kind = _TYPES.get(field.dtype.base.kind, "integer")
    unit = field.unit
    if options.enums and field.enum is not None:
        kind = "string"
    elif options.scaled and kind == "integer" and not field.name.startswith("_"):
        kind = "number"
    elif field.multiplier != 1:
        unit += f" times {field.multiplier:g}"
    notes = [
        text for text in (field.description, unit and f"[{unit}]", field.enum and field.enum.name) if text
    ]
    value: dict[str, Any] = {"type": kind}
    if field.array_length:
        value = {"type": "array", "items": value}
    if notes:
        value["description"] = " ".join(notes)
    return value


MCAP: Final = LogExporter("mcap", "MCAP for Foxglove, one file", ".mcap", False, McapWriter)
