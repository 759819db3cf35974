"""MCAP: one file with a channel for each message of each component, which Foxglove opens.

Messages are JSON with a JSON schema of their fields, with units in the descriptions. Positions and texts come
also as `foxglove.LocationFix` and `foxglove.Log`, which Foxglove's map and log panels show.
"""

from __future__ import annotations

import json
from importlib import import_module
from math import isfinite
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack.errors import MissingExtraError
from mavstack.logs.export.flights import by_vehicle
from mavstack.logs.export.registry import LogExporter
from mavstack.logs.export.writer import ExportOptions, PartFile, TableWriter
from mavstack.logs.tracks import tracks

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable
    from mavstack.logs.schema import FieldSchema, TableSchema

_NANOSECONDS: Final = 1_000_000_000
#: MCAP counts nanoseconds in 64 bits.
_MAX_MICROSECONDS: Final = (2**64 - 1) // 1000
#: Level of foxglove.Log by MAV_SEVERITY: 5 fatal, 4 error, 3 warning, 2 info, 1 debug.
_LEVELS: Final = (5, 5, 5, 4, 3, 2, 2, 1)
#: Types of JSON by the kind of a column's type; the others are integers.
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
        try:
            module = import_module("mcap.writer")
        except ImportError:
            raise MissingExtraError("the export to MCAP", "data") from None
        self._file = PartFile(path)
        self._stream = self._file.temporary.open("wb")
        self._writer = module.Writer(self._stream)
        self._writer.start(profile="", library="mavstack")
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._start = log.time_span or (0.0, 0.0)

    def write(self, tables: Mapping[str, MessageTable]) -> None:
        """Write the next rows; see `TableWriter.write`."""
        for system, name, table in by_vehicle(self.log, tables):
            self._write_table(f"/{system}/{name}" if system else f"/{name}", name, table)

    def finish(self) -> list[Path]:
        """Complete the file; see `ExportWriter.finish`."""
        self._write_locations()
        self._write_texts()
        self._writer.add_metadata("mavstack", {"file": self.log.path.name, "format": self.log.format})
        self._writer.finish()
        self._stream.close()
        return [self._file.complete()]

    def discard(self) -> None:
        """Remove an incomplete file; see `ExportWriter.discard`."""
        self._stream.close()
        self._file.discard()

    def _write_table(self, topic: str, name: str, table: MessageTable) -> None:
        channel = self._channel(topic, name, table.schema)
        times = self._nanoseconds(self.log.times_of(name, table))
        add = self._writer.add_message
        for time, row in zip(times, self._rows(table), strict=True):
            add(channel, time, json.dumps(row, allow_nan=False).encode(), time)

    def _rows(self, table: MessageTable) -> Iterator[dict[str, Any]]:
        """Yield the rows as values that JSON can hold; numbers that are no finite number are null."""
        names = [name for name in table.dtype.names or () if name != "_time"]
        columns = [self._values(table, name) for name in names]
        return (dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True))

    def _values(self, table: MessageTable, name: str) -> list[Any]:
        schema = table.schema[name]
        if self.options.enums and schema.enum is not None:
            return list(table.enum_names(name).tolist())
        column = np.asarray(table[name])
        if self.options.scaled and column.dtype.kind in "iuf" and not name.startswith("_"):
            column = table.scaled(name)
        if column.dtype.kind == "S":
            return list(np.char.decode(column, "utf-8", "replace").tolist())
        values: list[Any] = column.tolist()
        if column.dtype.kind == "f" and not np.isfinite(column).all():
            return [_finite(value) for value in values]
        return values

    def _nanoseconds(self, seconds: np.ndarray[Any, np.dtype[np.float64]]) -> list[int]:
        """Return times as MCAP has them; a time that is not known is that of the beginning."""
        known = np.where(np.isfinite(seconds), seconds, self._start[0])
        return [_clamped(round(time * 1e6)) * 1000 for time in known.tolist()]

    def _channel(self, topic: str, name: str, schema: TableSchema) -> int:
        if topic not in self._channels:
            if name not in self._schemas:
                self._schemas[name] = self._register_schema(name, _json_schema(schema, self.options))
            self._channels[topic] = self._register_channel(topic, self._schemas[name])
        return self._channels[topic]

    def _register_schema(self, name: str, schema: Mapping[str, Any]) -> int:
        data = json.dumps(schema).encode()
        number: int = self._writer.register_schema(name=name, encoding="jsonschema", data=data)
        return number

    def _register_channel(self, topic: str, schema: int) -> int:
        number: int = self._writer.register_channel(topic=topic, message_encoding="json", schema_id=schema)
        return number

    def _write_locations(self) -> None:
        found = tracks(self.log)
        schema = self._register_schema("foxglove.LocationFix", _LOCATION_SCHEMA) if found else 0
        for track in found:
            topic = f"/{track.system}/location" if track.system else "/location"
            channel = self._register_channel(topic, schema)
            columns = (track.latitudes.tolist(), track.longitudes.tolist(), track.altitudes.tolist())
            for time, latitude, longitude, altitude in zip(
                self._nanoseconds(track.times), *columns, strict=True
            ):
                position = {"latitude": latitude, "longitude": longitude, "altitude": altitude}
                self._add(channel, time, {**position, "position_covariance_type": 0, "frame_id": ""})

    def _write_texts(self) -> None:
        texts = self.log.texts
        if not texts:
            return
        channel = self._register_channel("/log", self._register_schema("foxglove.Log", _LOG_SCHEMA))
        for text in texts:
            time = text.boot_us or 0
            if not np.isnat(text.time):
                time = int(text.time.astype("M8[us]").astype(np.int64))
            level = _LEVELS[min(max(text.severity, 0), 7)]
            values = {"level": level, "message": text.text, "name": str(text.system), "file": "", "line": 0}
            self._add(channel, _clamped(time) * 1000, values)

    def _add(self, channel: int, time: int, values: dict[str, Any]) -> None:
        seconds, nanoseconds = divmod(time, _NANOSECONDS)
        content = {"timestamp": {"sec": seconds, "nsec": nanoseconds}, **values}
        self._writer.add_message(channel, time, json.dumps(content).encode(), time)


def _clamped(microseconds: int) -> int:
    """Return the nearest time that MCAP can hold; damaged records have any time."""
    return min(max(microseconds, 0), _MAX_MICROSECONDS)


def _finite(value: Any) -> Any:  # noqa: ANN401 (a number, or a list of numbers)
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return value if isfinite(value) else None


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
