"""Record types of a DataFlash log: their columns, the rows of their tables and the meaning of the columns.

The format characters define the values: `c`, `C`, `e` and `E` are hundredths and `L` is 10^-7 degrees, all
converted to float64; the others are stored as they are. The multiplier of a field (MULT) concerns the stored
number. It is therefore in the schema only where the value is not converted already.

`M` (flight mode) is an unsigned byte, as ArduPilot writes it. `Data` of FILE holds the bytes of a file, all
other characters are text.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack._core import DataFlashLayout
from mavstack.logs.schema import FieldSchema, TableSchema

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from typing import Any

    from mavstack.logs.schema import EnumSchema

#: Length of a field in the record, and its type in the table, by format character.
_CHARACTERS: Final[Mapping[str, tuple[int, Any]]] = {
    "a": (64, ("<i2", (32,))),
    "b": (1, "i1"),
    "B": (1, "u1"),
    "h": (2, "<i2"),
    "H": (2, "<u2"),
    "i": (4, "<i4"),
    "I": (4, "<u4"),
    "q": (8, "<i8"),
    "Q": (8, "<u8"),
    "g": (2, "<f2"),
    "f": (4, "<f4"),
    "d": (8, "<f8"),
    "c": (2, "<f8"),
    "C": (2, "<f8"),
    "e": (4, "<f8"),
    "E": (4, "<f8"),
    "L": (4, "<f8"),
    "M": (1, "u1"),
    "n": (4, "S4"),
    "N": (16, "S16"),
    "Z": (64, "S64"),
}
SCALED: Final = "cCeEL"
TEXTS: Final = "nNZ"
_INTEGERS: Final = "bBMhHiIqQ"
#: A field that holds the bytes of a file: (record type, field).
_FILE_BYTES: Final = ("FILE", "Data")
_RECORD_HEADER: Final = 3
ROW_HEADER: Final = 12
HEADER_COLUMNS: Final = (("_time", "<M8[us]", 0), ("_instance", "u1", 8))
#: Column of record types without a time: the boot time of the previous record, in microseconds.
NEIGHBOUR_TIME: Final = "_boot_us"
_HEADER_DESCRIPTIONS: Final = {
    "_time": "Time in UTC, from the time since boot and the GPS time",
    "_instance": "Number of the sensor; 0 in tables without instances",
    NEIGHBOUR_TIME: "Time since boot of the record before; records of this type have no time",
}
#: Record types whose TimeMS is not the time since boot.
_OTHER_CLOCKS: Final = ("ACC", "GYR")
#: Unit and factor of integer fields in logs of old firmware, which name no units; later firmware logs floats.
_OLD_UNITS: Final[Mapping[tuple[str, str], tuple[str, float]]] = {
    (name, label): unit
    for name in ("CURR", "CUR2")
    for label, unit in {
        "Volt": ("V", 1e-2), "Volt2": ("V", 1e-2), "Curr": ("A", 1e-2), "Vcc": ("V", 1e-3),
    }.items()
}  # fmt: skip
#: Units with more detail than a column needs, and the unit that replaces them.
_UNITS: Final = {
    "deglatitude": "deg",
    "deglongitude": "deg",
    "degheading": "deg",
    "UNKNOWN": "",
    "instance": "",
}


@dataclass(frozen=True, slots=True)
class Column:
    """A field of a record.

    Attributes:
        name: Its name, unique in the record.
        character: Its format character.
        source: Its position in the record, header included.
        index: Its number in the format.
    """

    name: str
    character: str
    source: int
    index: int


@dataclass(frozen=True, slots=True)
class Units:
    """Unit and multiplier of each field, from FMTU, UNIT and MULT.

    Attributes:
        units: Unit by index of the field.
        multipliers: Multiplier by index of the field; 0 for none.
        instance: Index of the field with the number of the sensor, or None.
    """

    units: Mapping[int, str] = field(default_factory=dict)
    multipliers: Mapping[int, float] = field(default_factory=dict)
    instance: int | None = None


@dataclass(frozen=True)
class RecordType:
    """The definition of a table.

    Args:
        name: Name of the record type.
        format: Format characters of its fields.
        labels: Names of its fields, separated by commas.
        length: Length of a record in bytes.
        units: Units of the fields.
        enums: Named values of fields, by field.
    """

    name: str
    format: str
    labels: str
    length: int
    units: Units = field(default_factory=Units)
    enums: Mapping[str, EnumSchema] = field(default_factory=dict)

    @classmethod
    def of(cls, name: bytes, characters: bytes, labels: bytes, length: int) -> RecordType:
        """Return a definition as it is in the file.

        Args:
            name: Name of the record type.
            characters: Format characters of its fields.
            labels: Names of its fields, separated by commas.
            length: Length of a record in bytes.
        """
        return cls(name.decode("latin-1"), characters.decode("latin-1"), labels.decode("latin-1"), length)

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """The fields that have a label, a known format character and a place in the record."""
        columns, source = [], _RECORD_HEADER
        labels = _unique(self.labels.split(",") if self.labels else [])
        for index, (character, label) in enumerate(zip(self.format, labels, strict=False)):
            length = _CHARACTERS.get(character, (self.length, None))[0]
            if character not in _CHARACTERS or source + length > self.length:
                break
            columns.append(Column(label, character, source, index))
            source += length
        return tuple(columns)

    @property
    def lost_fields(self) -> int:
        """Number of fields that cannot be read: an unknown format character, or no place in the record."""
        return min(len(self.format), self.labels.count(",") + bool(self.labels)) - len(self.columns)

    @cached_property
    def integer_columns(self) -> frozenset[str]:
        """Names of the columns that hold integers."""
        return frozenset(column.name for column in self.columns if column.character in _INTEGERS)

    @property
    def time_column(self) -> tuple[Column, int] | None:
        """The column with the time since boot, and its unit in microseconds."""
        columns = {column.name: column for column in self.columns if column.character in "QqIi"}
        if "TimeUS" in columns:
            return columns["TimeUS"], 1
        # GPS messages of old firmware have the GPS time of the week in TimeMS.
        name = "T" if self.name in ("GPS", "GPS2") else "TimeMS"
        if name in columns and not self.name.startswith(_OTHER_CLOCKS):
            return columns[name], 1000
        return None

    @property
    def instance_column(self) -> Column | None:
        """The column with the number of the sensor, if it is a number."""
        columns = (column for column in self.columns if column.index == self.units.instance)
        return next((column for column in columns if column.character in _INTEGERS), None)

    @cached_property
    def dtype(self) -> np.dtype[np.void]:
        """The type of the table's rows."""
        names = [name for name, _, _ in self._header]
        formats: list[Any] = [kind for _, kind, _ in self._header]
        offsets = [offset for _, _, offset in self._header]
        end = offsets[-1] + np.dtype(formats[-1]).itemsize if self.time_column is None else ROW_HEADER
        for column in self.columns:
            names.append(column.name)
            formats.append(self._column_type(column))
            offsets.append(end)
            end += np.dtype(formats[-1]).itemsize
        return np.dtype(
            {"names": names, "formats": formats, "offsets": offsets, "itemsize": (end + 3) // 4 * 4}
        )

    @property
    def _header(self) -> tuple[tuple[str, str, int], ...]:
        """The columns before the fields: name, type, and place in the row."""
        own = ((NEIGHBOUR_TIME, "<i8", ROW_HEADER),) if self.time_column is None else ()
        return (*HEADER_COLUMNS, *own)

    def _column_type(self, column: Column) -> Any:  # noqa: ANN401 (all that numpy takes as a type)
        return ("u1", (64,)) if self._is_file(column) else _CHARACTERS[column.character][1]

    def _is_file(self, column: Column) -> bool:
        return (self.name, column.name) == _FILE_BYTES and column.character == "Z"

    def layout(self, offset_us: int | None) -> DataFlashLayout:
        """Return how a record becomes a row.

        Args:
            offset_us: UTC minus time since boot in microseconds; None if it is not known.
        """
        fields = [
            (column.character, self._conversion(column), column.source, self._target(column))
            for column in self.columns
        ]
        found, time = self.time_column, None
        if found is not None and offset_us is not None:
            time = (found[0].character, found[0].source, found[1], offset_us)
        counter = self.instance_column
        instance = None if counter is None else (counter.character, counter.source)
        return DataFlashLayout(self.length, self.dtype.itemsize, fields, time=time, instance=instance)

    def _conversion(self, column: Column) -> str:
        if column.character in SCALED:
            return "*"
        return "0" if column.character in TEXTS and not self._is_file(column) else "="

    def _target(self, column: Column) -> int:
        fields = self.dtype.fields
        return int(fields[column.name][1]) if fields is not None else 0

    def schema(self, name: str) -> TableSchema:
        """Return the meaning of the columns.

        Args:
            name: Name of the table.
        """
        header = (
            FieldSchema(
                column,
                np.dtype(kind),
                "s" if column == NEIGHBOUR_TIME else "",
                1e-6 if column == NEIGHBOUR_TIME else 1.0,
                description=_HEADER_DESCRIPTIONS[column],
            )
            for column, kind, _ in self._header
        )
        fields = (self._field_schema(column) for column in self.columns)
        instance = "_instance" if self.instance_column is not None else ""
        return TableSchema(name, (*header, *fields), instance_field=instance, source="file")

    def _field_schema(self, column: Column) -> FieldSchema:
        unit = self.units.units.get(column.index, "")
        factor = self.units.multipliers.get(column.index, 0.0) or 1.0
        old = _OLD_UNITS.get((self.name, column.name))
        if old is not None and not unit and column.character in _INTEGERS:
            unit, factor = old
        return FieldSchema(
            column.name,
            self.dtype[column.name],
            _UNITS.get(unit, unit),
            1.0 if column.character in SCALED + TEXTS else factor,
            None if column.character in TEXTS else self.enums.get(column.name),
        )


def _unique(labels: list[str]) -> list[str]:
    """Return the labels as names of columns: no empty ones, none twice, none of the header."""
    seen = Counter([*(name for name, _, _ in HEADER_COLUMNS), NEIGHBOUR_TIME])
    names = []
    for index, label in enumerate(labels):
        name = label.strip() or f"field_{index}"
        seen[name] += 1
        while seen[name] > 1:
            name = f"{name}_{seen[name]}"
            seen[name] += 1
        names.append(name)
    return names


def table_names(types: Iterable[tuple[int, str, int]]) -> dict[str, int]:
    """Return the slots of the record types that have rows by name of the table.

    A type whose fields change within a log has several definitions. The second one with rows is the table
    `NAME_2`.

    Args:
        types: Slot, name and number of rows of each definition.
    """
    tables: dict[str, int] = {}
    for slot, name, rows in types:
        table, number = name, 1
        while table in tables:
            number += 1
            table = f"{name}_{number}"
        if rows:
            tables[table] = slot
    return tables


def is_readable(kind: RecordType) -> bool:
    """Return whether strict readers can use a definition.

    Its texts must be ASCII, its format characters known, each with a label, and fill the records exactly.

    Args:
        kind: The definition.
    """
    is_name = kind.name.isprintable() and bool(kind.name) and " " not in kind.name
    if not is_name or not (kind.name + kind.labels).isascii():
        return False
    lengths = [_CHARACTERS[letter][0] if letter in _CHARACTERS else 0 for letter in kind.format]
    labels = kind.labels.split(",") if kind.labels else []
    return len(labels) == len(lengths) and all(lengths) and sum(lengths) + _RECORD_HEADER == kind.length
