"""A log of tables in memory, with any clock: for tests of what works with every format."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mavstack.errors import UnknownMessageError
from mavstack.logs import Log, LogDamage, MessageTable, TimeBase
from mavstack.logs.schema import schema_of_dtype


class MemoryLog(Log):
    """A log of the vehicle: `TimeUS` is the time since boot, and `offset_us` is UTC minus that, or None."""

    format = "dataflash"

    def __init__(self, tables, offset_us=None, path="00000001.BIN"):
        super().__init__(Path(path), 1000)
        self.offset_us = offset_us
        self.rows = {name: self.with_times(columns) for name, columns in tables.items()}

    def with_times(self, columns):
        boot = np.asarray(columns["TimeUS"], np.int64)
        fields = [(name, np.asarray(values).dtype) for name, values in columns.items()]
        table = np.empty(len(boot), [("_time", "<M8[us]"), *fields])
        offset = self.offset_us
        table["_time"] = np.datetime64("NaT", "us") if offset is None else (boot + offset).astype("M8[us]")
        for name, values in columns.items():
            table[name] = values
        return MessageTable.of(table)

    @property
    def counts(self):
        return {name: len(table) for name, table in self.rows.items()}

    def schema(self, name):
        if name not in self.rows:
            raise UnknownMessageError(name)
        return schema_of_dtype(name, self.rows[name].dtype)

    def decode_tables(self, names):
        return {name: self.rows[name] for name in names}

    @property
    def skipped(self):
        return LogDamage(bad_bytes=7)

    @property
    def time_span(self):
        times = np.concatenate([self.times(name) for name in self])
        return float(times.min()), float(times.max())

    def boot_times(self, name, table):
        return table["TimeUS"] / 1e6

    def read_time_base(self, log):
        if self.offset_us is None:
            return TimeBase("boot")
        return TimeBase("utc", self.offset_us, 5000, "GPS week and milliseconds")
