"""The numpy type of a message's table, whose rows the core writes.

A row is a header (time, system, component, sequence, protocol version) followed by the full payload as on the
wire, so that a packet becomes a row by copying. The names of header columns begin with an underscore, which
no field name of a definition does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from typing import Any

    from mavstack.dialects.model import FieldDefinition, MessageDefinition

HEADER_COLUMNS: tuple[tuple[str, str, int], ...] = (
    ("_time", "<M8[us]", 0),
    ("_system", "u1", 8),
    ("_component", "u1", 9),
    ("_sequence", "u1", 10),
    ("_version", "u1", 11),
)
HEADER_LENGTH = 12

_FORMATS = {
    "uint8_t": "u1",
    "uint8_t_mavlink_version": "u1",
    "int8_t": "i1",
    "uint16_t": "<u2",
    "int16_t": "<i2",
    "uint32_t": "<u4",
    "int32_t": "<i4",
    "uint64_t": "<u8",
    "int64_t": "<i8",
    "float": "<f4",
    "double": "<f8",
}


def _format(field: FieldDefinition) -> str | tuple[str, tuple[int]]:
    if field.type == "char":
        return f"S{field.array_length or 1}"
    scalar = _FORMATS[field.type]
    return (scalar, (field.array_length,)) if field.array_length else scalar


def field_dtype(field: FieldDefinition) -> np.dtype[Any]:
    """Return the type of a field's column, with the shape of an array field.

    Args:
        field: The definition of the field.
    """
    return np.dtype(_format(field))


def table_dtype(message: MessageDefinition, row_size: int) -> np.dtype[np.void]:
    """Return the structured type of a message's table.

    Args:
        message: The definition of the message.
        row_size: Size of a row in bytes.

    Returns:
        The type: the header columns, then the fields in the order of the definition.
    """
    return np.dtype(
        {
            "names": [name for name, _, _ in HEADER_COLUMNS] + [field.name for field in message.fields],
            "formats": [kind for _, kind, _ in HEADER_COLUMNS] + [_format(field) for field in message.fields],
            "offsets": [offset for _, _, offset in HEADER_COLUMNS]
            + [HEADER_LENGTH + field.offset for field in message.fields],
            "itemsize": row_size,
        }
    )
