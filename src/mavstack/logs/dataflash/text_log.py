"""DataFlash logs as text (`.log`), as ground stations write them: a record in a line, values after commas.

The lines hold the values in their units: an integer of hundredths in a binary log is a number with decimals
here, and the mode is a name. The tables have the types of a binary log, except that modes are texts.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack.logs.damage import LogDamage
from mavstack.logs.dataflash import clock
from mavstack.logs.dataflash.ardupilot_log import ArduPilotLog
from mavstack.logs.dataflash.record_type import SCALED, TEXTS, RecordType, table_names
from mavstack.logs.dataflash.units import SlotFinder, has_units, units_by_slot
from mavstack.logs.message_table import MessageTable

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from mavstack.logs.log_bytes import LogBytes

_FMT: Final = "FMT"
_FMT_TYPE: Final = RecordType(_FMT, "BBnNZ", "Type,Length,Name,Format,Columns", 1 << 16)
#: Text lines have no record length; this one exceeds any record, so that no field is cut off.
_ANY_LENGTH: Final = 1 << 16
_NOT_A_TIME: Final = np.datetime64("NaT", "us")


@dataclass(slots=True)
class _Lines:
    """The lines of one definition: the values of each, and the position of each in the file."""

    kind: RecordType
    rows: list[tuple[Any, ...]] = field(default_factory=list)
    positions: list[int] = field(default_factory=list)


class DataFlashTextLog(ArduPilotLog):
    """A DataFlash log as text, which is read when it is opened.

    Args:
        data: The bytes of the file.

    Raises:
        LogError: The file cannot be read.
    """

    format = "dataflash-text"

    def __init__(self, data: LogBytes) -> None:
        super().__init__(data.path, data.size)
        self._lines: list[_Lines] = [_Lines(_FMT_TYPE)]
        self._by_name = {_FMT: 0}
        self._slot_of: dict[tuple[str, str, str], int] = {}
        self._redefinitions: list[tuple[int, int, int]] = []
        self._unknown: dict[str, int] = {}
        self._bad_lines = self._bad_bytes = 0
        with data.access() as content:
            self._read(bytes(content))
        names = ((slot, lines.kind.name, len(lines.rows)) for slot, lines in enumerate(self._lines))
        self._slots = table_names(names)
        self._add_units()

    @property
    def counts(self) -> Mapping[str, int]:
        """Number of records by table name."""
        return {name: len(self._lines[slot].rows) for name, slot in self._slots.items()}

    @property
    def definitions(self) -> Mapping[str, RecordType]:
        """The record type of each table."""
        return {name: self._lines[slot].kind for name, slot in self._slots.items()}

    # reading

    def _read(self, content: bytes) -> None:
        position = 0
        for line in content.splitlines(keepends=True):
            text = line.rstrip()
            if text:
                self._read_line(text, position)
            position += len(line)

    def _read_line(self, text: bytes, position: int) -> None:
        name = text.split(b",", 1)[0].decode("latin-1").strip()
        slot = self._by_name.get(name)
        if slot is None:
            self._skip(name, text)
            return
        lines = self._lines[slot]
        values = _parse(lines.kind, text)
        if values is None:
            self._bad_lines += 1
            return
        lines.rows.append(values)
        lines.positions.append(position)
        if name == _FMT:
            self._define(values, position)

    def _skip(self, name: str, text: bytes) -> None:
        """Count a line of an unknown type, or any other line such as those before the first FMT."""
        if b"," in text and name.isidentifier():
            self._unknown[name] = self._unknown.get(name, 0) + 1
        else:
            self._bad_bytes += len(text)

    def _define(self, values: tuple[Any, ...], position: int) -> None:
        """Apply an FMT line."""
        number, _, name, characters, labels = values
        # Text logs hold the name of a flight mode (M), so read it as a text (N).
        kind = RecordType.of(name, characters.replace(b"M", b"N"), labels, _ANY_LENGTH)
        if kind.name == _FMT:
            return
        slot = self._slot_of.setdefault((kind.name, kind.format, kind.labels), len(self._lines))
        if slot == len(self._lines):
            self._lines.append(_Lines(kind))
        self._by_name[kind.name] = slot
        self._redefinitions.append((position, number, slot))

    def _add_units(self) -> None:
        tables = {
            name: self._rows(self._slots[name]) for name in ("FMTU", "UNIT", "MULT") if name in self._slots
        }
        fmtu = tables.get("FMTU")
        if fmtu is None or not has_units(fmtu):
            return
        rows = dict(zip(self._lines[self._slots["FMTU"]].positions, fmtu, strict=True))
        slot = SlotFinder(self._redefinitions).slot
        for number, units in units_by_slot(rows, tables.get("UNIT"), tables.get("MULT"), slot).items():
            lines = self._lines[number]
            lines.kind = replace(lines.kind, units=units)

    # tables

    def _rows(self, slot: int, rows: slice = slice(None)) -> NDArray[np.void]:
        """Return a part of a table without times."""
        kind, values = self._lines[slot].kind, self._lines[slot].rows[rows]
        table = np.zeros(len(values), kind.dtype)
        table["_time"] = _NOT_A_TIME
        for number, column in enumerate(kind.columns):
            table[column.name] = [row[number] for row in values]
        instance = kind.instance_column
        if instance is not None:
            table["_instance"] = np.clip(table[instance.name].astype(np.int64), 0, 255)
        return table

    def decode_tables(self, names: Sequence[str]) -> Mapping[str, MessageTable]:
        """Make tables of the lines; see `Log.decode_tables`."""
        return {name: self._table(name) for name in names}

    def _table(self, name: str) -> MessageTable:
        table = self.rows_without_time(name)
        offset, found = self.time_base.offset_us, self.definitions[name].time_column
        if offset is not None and found is not None:
            column, factor = found
            times = table[column.name].astype(np.int64) * factor + offset
            table["_time"] = times.view("M8[us]")
        if found is None:
            self.fill_neighbour_times(name, table, self._times_before(self._lines[self._slots[name]]))
        return MessageTable.of(table, self._schema_source(name))

    def _times_before(self, lines: _Lines) -> NDArray[np.int64]:
        """Return the time since boot in microseconds of the line with a time before each line."""
        timed = []
        for slot in self._slots.values():
            other = self._lines[slot]
            times = clock.boot_microseconds(other.kind, self._rows(slot))
            if times is not None:
                timed.append((np.array(other.positions, np.int64), times))
        return clock.times_before(np.array(lines.positions, np.int64), timed)

    def rows_without_time(self, name: str) -> NDArray[np.void]:
        """Return a table whose column `_time` is not filled."""
        return self._rows(self._slots[name])

    def first_and_last(self) -> dict[str, tuple[NDArray[np.void], NDArray[np.void]]]:
        """Return the first and the last row of each table, as tables of one row without `_time`."""
        ends = slice(0, 1), slice(-1, None)
        return {
            name: (self._rows(slot, ends[0]), self._rows(slot, ends[1])) for name, slot in self._slots.items()
        }

    # damage

    @property
    def skipped(self) -> LogDamage:
        """Lines that are no record, or of unknown types, or whose values cannot be read."""
        unknown = {f"lines of unknown type {name}": count for name, count in self._unknown.items()}
        return LogDamage(bad_bytes=self._bad_bytes, bad_records=self._bad_lines, other=unknown)


def _parse(kind: RecordType, text: bytes) -> tuple[Any, ...] | None:
    """Return the values of a line, or None if one is missing or cannot be read."""
    columns = kind.columns
    values = [value.strip() for value in text.split(b",", len(columns))[1:]]
    if not columns or len(values) < len(columns) - (columns[-1].character in TEXTS):
        return None
    # Restore an empty text at the end of a line, and remove a comma after the last number.
    values += [b""] * (len(columns) - len(values))
    if columns[-1].character not in TEXTS:
        values[-1] = values[-1].rstrip(b", ")
    try:
        return tuple(_PARSERS[column.character](value) for column, value in zip(columns, values, strict=True))
    except (ValueError, OverflowError):
        return None


def _integer(dtype: str) -> Callable[[bytes], int]:
    limits = np.iinfo(dtype)

    def parse(value: bytes) -> int:
        number = int(value)
        if not limits.min <= number <= limits.max:
            raise OverflowError
        return number

    return parse


def _array(value: bytes) -> list[int]:
    numbers = [int(number) for number in value.strip(b"[]").split()]
    if len(numbers) != 32:
        raise ValueError
    return numbers


_PARSERS: Final[Mapping[str, Callable[[bytes], Any]]] = {
    **{
        character: _integer(dtype)
        for character, dtype in zip("bBhHiIqQ", ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8"), strict=True)
    },
    **dict.fromkeys("fdg" + SCALED, float),
    **dict.fromkeys(TEXTS, bytes),
    "a": _array,
}
