"""What a definition says, as immutable values: dialects, messages, fields, enums, entries and parameters.

The names follow the developer guide. A field's `type` is the C name of its element (`uint8_t`, `char`);
`array_length` is 0 for a single value. Texts which a definition may leave out are the empty string, and
numbers which it may leave out are `None`. `line` is where an XML file said it, for error texts only: it is
0 in our own tables and takes no part in comparisons. Whatever can be computed from a message's fields
(offsets, lengths, CRC_EXTRA) is filled in by `layout.lay_out`, never by hand.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

Number: TypeAlias = int | float

#: Bytes of one element, by type name.
TYPE_SIZES = {
    "char": 1,
    "int8_t": 1,
    "uint8_t": 1,
    "int16_t": 2,
    "uint16_t": 2,
    "int32_t": 4,
    "uint32_t": 4,
    "float": 4,
    "int64_t": 8,
    "uint64_t": 8,
    "double": 8,
}


@dataclass(frozen=True, slots=True)
class Replacement:
    """A mark that a message, enum or entry should no longer be used, since when, and what to use instead."""

    since: str = ""
    replaced_by: str = ""
    description: str = ""


@dataclass(frozen=True, slots=True)
class FieldDefinition:
    """One field of a message."""

    name: str
    type: str
    array_length: int = 0
    enum: str = ""
    units: str = ""
    multiplier: str = ""
    invalid: str = ""
    print_format: str = ""
    display: str = ""
    default: str = ""
    minimum: Number | None = None
    maximum: Number | None = None
    increment: Number | None = None
    instance: bool = False
    extension: bool = False
    protocol_version: bool = False
    description: str = ""
    offset: int = 0
    line: int = field(default=0, compare=False, repr=False)

    @property
    def size(self) -> int:
        """Bytes this field takes in the payload."""
        return TYPE_SIZES[self.type] * max(self.array_length, 1)

    @property
    def is_integer(self) -> bool:
        """Whether elements are integers, and so may be enum values."""
        return self.type not in ("float", "double", "char")

    @property
    def factor(self) -> float:
        """What a raw value is multiplied by to give a value in `units`."""
        if not self.multiplier:
            return 1.0
        numerator, _, denominator = self.multiplier.partition("/")
        return float(numerator) / float(denominator or 1)

    @property
    def value_range(self) -> tuple[Number, Number] | None:
        """The least and greatest number the wire type can hold, or `None` for text."""
        if self.type == "char":
            return None
        if self.type in ("float", "double"):
            limit = 3.4028234663852886e38 if self.type == "float" else 1.7976931348623157e308
            return -limit, limit
        bits = TYPE_SIZES[self.type] * 8
        return (0, 2**bits - 1) if self.type.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


@dataclass(frozen=True)
class MessageDefinition:
    """One message, its fields in the order of the definition."""

    id: int
    name: str
    fields: tuple[FieldDefinition, ...]
    crc_extra: int
    base_length: int
    length: int
    description: str = ""
    deprecated: Replacement | None = None
    superseded: Replacement | None = None
    wip: bool = False
    wip_since: str = ""
    origin: str = ""
    line: int = field(default=0, compare=False, repr=False)

    @cached_property
    def wire_order(self) -> tuple[FieldDefinition, ...]:
        """The fields as they lie in the payload."""
        return tuple(sorted(self.fields, key=lambda item: item.offset))

    @cached_property
    def by_name(self) -> dict[str, FieldDefinition]:
        """The fields by their official names."""
        return {item.name: item for item in self.fields}

    def field(self, name: str) -> FieldDefinition:
        """The field of that official name."""
        return self.by_name[name]


@dataclass(frozen=True, slots=True)
class EnumParam:
    """One of the seven parameters of a command."""

    index: int
    label: str = ""
    units: str = ""
    multiplier: str = ""
    enum: str = ""
    minimum: Number | None = None
    maximum: Number | None = None
    increment: Number | None = None
    decimal_places: int | None = None
    default: str = ""
    reserved: bool = False
    instance: bool = False
    description: str = ""


@dataclass(frozen=True, slots=True)
class EnumEntry:
    """One named value of an enum."""

    name: str
    value: int
    params: tuple[EnumParam, ...] = ()
    has_location: bool = False
    is_destination: bool = False
    has_altitude_only: bool = False
    mission_only: bool = False
    mission: bool = False
    fence: bool = False
    rally: bool = False
    command: bool = False
    deprecated: Replacement | None = None
    superseded: Replacement | None = None
    wip: bool = False
    wip_since: str = ""
    description: str = ""
    automatic: bool = field(default=False, compare=False, repr=False)
    line: int = field(default=0, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class EnumDefinition:
    """A set of named values; `bitmask` when they combine."""

    name: str
    entries: tuple[EnumEntry, ...]
    bitmask: bool = False
    deprecated: Replacement | None = None
    superseded: Replacement | None = None
    wip: bool = False
    wip_since: str = ""
    description: str = ""
    line: int = field(default=0, compare=False, repr=False)

    def entry(self, value: int) -> EnumEntry | None:
        """The entry of that value, if there is one."""
        return next((entry for entry in self.entries if entry.value == value), None)


@dataclass(frozen=True, eq=False)
class DialectDefinition:
    """Messages and enums of one file, or of a file with all that it includes.

    `includes` holds what the file wrote: names of files.
    """

    name: str
    version: int | None
    number: int | None
    includes: tuple[str, ...]
    messages: tuple[MessageDefinition, ...]
    enums: tuple[EnumDefinition, ...]
    path: str = ""
    include_lines: tuple[int, ...] = ()

    @cached_property
    def messages_by_name(self) -> dict[str, MessageDefinition]:
        """The messages by their official names."""
        return {message.name: message for message in self.messages}

    @cached_property
    def enums_by_name(self) -> dict[str, EnumDefinition]:
        """The enums by their official names."""
        return {enum.name: enum for enum in self.enums}
