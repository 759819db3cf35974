"""The numpy type of a topic's table, whose rows the core writes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.schema import FieldSchema, TableSchema

if TYPE_CHECKING:
    from collections.abc import Sequence

#: Name, type and offset of the columns before the fields.
HEADER_COLUMNS: Final = (("_time", "<M8[us]", 0), ("_instance", "u1", 8))

_FORMATS: Final = {
    "int8_t": "i1",
    "uint8_t": "u1",
    "int16_t": "<i2",
    "uint16_t": "<u2",
    "int32_t": "<i4",
    "uint32_t": "<u4",
    "int64_t": "<i8",
    "uint64_t": "<u8",
    "float": "<f4",
    "double": "<f8",
    "bool": "?",
}
_UNITS: Final = {"timestamp": "us"}
_DESCRIPTIONS: Final = {
    "_time": "Time in UTC",
    "_instance": "Instance of the topic",
    "timestamp": "Time since boot",
}


def table_dtype(row_size: int, columns: Sequence[tuple[str, str, int, int]]) -> np.dtype[np.void]:
    """Return the structured type of a topic's table.

    Args:
        row_size: Size of a row in bytes.
        columns: For each field its name, its type in ULog, the number of elements (0 for a single value) and
            its position in the row.
    """
    formats = [_format(kind, count) for _, kind, count, _ in columns]
    return np.dtype(
        {
            "names": [name for name, _, _ in HEADER_COLUMNS] + [name for name, *_ in columns],
            "formats": [kind for _, kind, _ in HEADER_COLUMNS] + formats,
            "offsets": [offset for _, _, offset in HEADER_COLUMNS] + [offset for *_, offset in columns],
            "itemsize": row_size,
        }
    )


def _format(kind: str, count: int) -> str | tuple[str, tuple[int]]:
    if kind == "char":
        return f"S{count or 1}"
    return (_FORMATS[kind], (count,)) if count else _FORMATS[kind]


def table_schema(topic: str, dtype: np.dtype[np.void]) -> TableSchema:
    """Return the schema of a topic's table; the format knows no units except that of times.

    Args:
        topic: Name of the topic.
        dtype: Type of the table.
    """
    fields = [
        FieldSchema(name, dtype[name], unit=_UNITS.get(name, ""), description=_DESCRIPTIONS.get(name, ""))
        for name in dtype.names or ()
    ]
    return TableSchema(topic, tuple(fields), instance_field="_instance", source="file")
