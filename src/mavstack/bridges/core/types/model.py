"""The model of an interface definition: fields, their types, and constants."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final

#: The primitive types of interface definitions with their `struct` format characters; "" for strings.
PRIMITIVES: Final = {
    "bool": "?",
    "byte": "B",
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
    "string": "",
}


class Container(Enum):
    """The number of values that a field holds."""

    ONE = "one"
    ARRAY = "array"
    BOUNDED = "bounded sequence"
    SEQUENCE = "sequence"


@dataclass(frozen=True, slots=True)
class FieldType:
    """The type of a field.

    Attributes:
        base: A primitive type, or the full name of a message such as "geometry_msgs/msg/Point".
        container: The number of values.
        size: The number of elements of an array, or the bound of a sequence.
        text_bound: The largest number of letters of a text; 0: any.
    """

    base: str
    container: Container = Container.ONE
    size: int = 0
    text_bound: int = 0

    @property
    def is_message(self) -> bool:
        """True if the values are messages."""
        return self.base not in PRIMITIVES


@dataclass(frozen=True, slots=True)
class Field:
    """A field: its name, its type, and the text of its default value."""

    name: str
    type: FieldType
    default: str = ""


@dataclass(frozen=True, slots=True)
class Constant:
    """A constant of a definition: its type, name and the text of its value."""

    type: str
    name: str
    value: str


@dataclass(frozen=True, slots=True)
class Definition:
    """A message, or a service or an action as a structure of its messages.

    Attributes:
        name: The full name, such as "sensor_msgs/msg/Imu".
        fields: The fields in their order.
        constants: The constants.
    """

    name: str
    fields: tuple[Field, ...]
    constants: tuple[Constant, ...] = ()

    @property
    def dds_name(self) -> str:
        """The name of the type in DDS and on Zenoh, such as "sensor_msgs::msg::dds_::Imu_"."""
        package, kind, name = self.name.split("/")
        return f"{package}::{kind}::dds_::{name}_"

    @property
    def has_header(self) -> bool:
        """True if the first field is a std_msgs/Header."""
        return bool(self.fields) and self.fields[0].type == FieldType("std_msgs/msg/Header")
