"""The meaning of the columns of a table: units, multipliers, enums, invalid values and descriptions.

A table holds values as they are stored. The schema says how they are read: `value * multiplier` is in `unit`,
an integer names an entry of `enum`, and an invalid value stands for "unknown". Schemas are plain values, so
that they can be pickled, compared and written into the metadata of other formats.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping
    from typing import Any

    import numpy as np

DType: TypeAlias = "np.dtype[Any]"


@dataclass(frozen=True, slots=True)
class EnumSchema:
    """The named values of an integer column.

    Attributes:
        name: Name of the enum, such as `MAV_TYPE`.
        values: Names by value, such as `{2: "QUADROTOR"}`.
        bitmask: True if a value is a combination of flags.
    """

    name: str
    values: Mapping[int, str]
    bitmask: bool = False

    def name_of(self, value: int) -> str:
        """Return the name of a value.

        Args:
            value: The value of a row.

        Returns:
            The name; of a bitmask the names of all its flags, joined by `|`. A value or flag without a name
            is returned as its number.
        """
        name = self.values.get(value)
        if name is not None or not self.bitmask or value <= 0:
            return str(value) if name is None else name
        names, rest = [], value
        for flag, flag_name in sorted(self.values.items()):
            if flag > 0 and flag & rest == flag:
                names.append(flag_name)
                rest &= ~flag
        return "|".join([*names, *([f"0x{rest:x}"] if rest else [])])


@dataclass(frozen=True, slots=True)
class FieldSchema:
    """The meaning of one column.

    Attributes:
        name: Name of the column.
        dtype: Type of the column; an array field has a type with a shape.
        unit: Unit of `value * multiplier`, such as `m/s`; empty if there is none or it is not known.
        multiplier: Factor that converts a stored value to the unit.
        enum: The named values, or None.
        invalid: The values that stand for "unknown": empty for none, one that holds for all elements, or one
            (or None) for each element of an array.
        invalid_by_first: Value of the first element that marks all elements as unknown, or None.
        description: One line of text, or empty.
    """

    name: str
    dtype: DType
    unit: str = ""
    multiplier: float = 1.0
    enum: EnumSchema | None = None
    invalid: tuple[float | None, ...] = ()
    invalid_by_first: float | None = None
    description: str = ""

    @property
    def array_length(self) -> int:
        """Number of elements of an array field; 0 for a single value."""
        return int(self.dtype.shape[0]) if self.dtype.shape else 0

    @property
    def is_number(self) -> bool:
        """True for a column with one number in each row."""
        return self.dtype.kind in "iufb" and not self.dtype.shape

    def to_dict(self) -> dict[str, Any]:
        """Return the schema as values that JSON can hold, without those that say nothing."""
        values: dict[str, Any] = {"name": self.name, "type": self.dtype.base.str}
        if self.array_length:
            values["array_length"] = self.array_length
        if self.unit:
            values["unit"] = self.unit
        if self.multiplier != 1.0:
            values["multiplier"] = self.multiplier
        if self.enum is not None:
            values["enum"] = self.enum.name
            values["enum_values"] = {str(value): name for value, name in self.enum.values.items()}
            values["bitmask"] = self.enum.bitmask
        if self.description:
            values["description"] = self.description
        return values


@dataclass(frozen=True)
class TableSchema:
    """The meaning of a table: its columns in order.

    Attributes:
        name: Name of the table: of the message, the topic or the record type.
        fields: The columns, those of the header (`_time` …) first.
        description: One line of text, or empty.
        instance_field: Name of the column that tells the instances of a sensor apart (`_instance`, `id`), or
            empty.
        source: Origin of the definition: name of the dialect, or "file" for a self-describing log.
        message_id: Id of the MAVLink message, or None.
    """

    name: str
    fields: tuple[FieldSchema, ...]
    description: str = ""
    instance_field: str = ""
    source: str = ""
    message_id: int | None = None

    @cached_property
    def by_name(self) -> dict[str, FieldSchema]:
        """The columns by name."""
        return {item.name: item for item in self.fields}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(item.name for item in self.fields)

    def __getitem__(self, name: str) -> FieldSchema:
        return self.by_name[name]

    def __contains__(self, name: object) -> bool:
        return name in self.by_name

    def __iter__(self) -> Iterator[FieldSchema]:
        return iter(self.fields)

    def __len__(self) -> int:
        return len(self.fields)

    def has_numbers(self, *names: str) -> bool:
        """Return whether the table has these columns, each with one number in a row.

        A log that defines its own tables may give a known name to anything.

        Args:
            names: Names of the columns.
        """
        return all(name in self.by_name and self.by_name[name].is_number for name in names)

    def restricted_to(self, names: Iterable[str]) -> TableSchema:
        """Return the schema of some columns.

        Args:
            names: Names of the columns; those that are not in the schema are left out.
        """
        kept = tuple(self.by_name[name] for name in names if name in self.by_name)
        instance = self.instance_field if any(item.name == self.instance_field for item in kept) else ""
        return TableSchema(self.name, kept, self.description, instance, self.source, self.message_id)

    def to_dict(self) -> dict[str, Any]:
        """Return the schema as values that JSON can hold."""
        values: dict[str, Any] = {"name": self.name, "source": self.source, "description": self.description}
        if self.message_id is not None:
            values["message_id"] = self.message_id
        if self.instance_field:
            values["instance_field"] = self.instance_field
        return values | {"fields": [item.to_dict() for item in self.fields]}


def schema_of_dtype(name: str, dtype: np.dtype[np.void]) -> TableSchema:
    """Return the schema of a structured array of which only the types are known.

    Args:
        name: Name of the table.
        dtype: Its type.
    """
    return TableSchema(name, tuple(FieldSchema(column, dtype[column]) for column in dtype.names or ()))


@dataclass(eq=False)
class SchemaSource:
    """A schema that is made when it is first read, shared by a table and its slices."""

    make: Callable[[], TableSchema] = field(repr=False)

    @cached_property
    def schema(self) -> TableSchema:
        """The schema."""
        return self.make()

    def __reduce__(self) -> tuple[Callable[[TableSchema], SchemaSource], tuple[TableSchema]]:
        return known_schema, (self.schema,)


def known_schema(schema: TableSchema) -> SchemaSource:
    """Return the source of a schema that exists already."""
    return SchemaSource(lambda: schema)
