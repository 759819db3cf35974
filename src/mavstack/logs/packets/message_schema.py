"""The schema of a message's table, from the definition of the message."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.dialects.enums import MavFlag
from mavstack.dialects.invalid_values import invalid_markers
from mavstack.logs.packets.tables import HEADER_COLUMNS, field_dtype
from mavstack.logs.packets.units import plain_unit
from mavstack.logs.schema import EnumSchema, FieldSchema, TableSchema

if TYPE_CHECKING:
    from mavstack.dialects import Dialect
    from mavstack.dialects.model import FieldDefinition

#: Instance fields that the definitions do not mark: each port has eight other channels.
_INSTANCES: Final = {"SERVO_OUTPUT_RAW": "port", "RC_CHANNELS_RAW": "port"}
_HEADER_DESCRIPTIONS: Final = {
    "_time": "Time in UTC at which the packet was recorded",
    "_system": "System id of the sender",
    "_component": "Component id of the sender",
    "_sequence": "Sequence number of the packet",
    "_version": "MAVLink version of the packet",
}


def message_schema(dialect: Dialect, message_id: int) -> TableSchema:
    """Return the schema of a message's table.

    Args:
        dialect: The dialect.
        message_id: Id of a message of the dialect.
    """
    definition = dialect.message_definition(message_id)
    header = (
        FieldSchema(name, np.dtype(kind), description=_HEADER_DESCRIPTIONS[name])
        for name, kind, _ in HEADER_COLUMNS
    )
    fields = (_field_schema(dialect, item) for item in definition.fields)
    own = _INSTANCES.get(definition.name, "")
    instance = next((item.name for item in definition.fields if item.instance or item.name == own), "")
    return TableSchema(
        definition.name, (*header, *fields), definition.description, instance, dialect.name, message_id
    )


def _field_schema(dialect: Dialect, item: FieldDefinition) -> FieldSchema:
    entries = dialect.enum_values(item.enum) if item.enum else {}
    each, by_first = invalid_markers(item, entries)
    enum = _enum_schema(dialect, item.enum) if item.enum and item.is_integer else None
    unit, factor = plain_unit(item.units, item.factor)
    return FieldSchema(item.name, field_dtype(item), unit, factor, enum, each, by_first, item.description)


def _enum_schema(dialect: Dialect, name: str) -> EnumSchema:
    members = dialect.enum_class(name)
    values = {int(member): text for text, member in members.__members__.items()}
    return EnumSchema(name, values, issubclass(members, MavFlag))
