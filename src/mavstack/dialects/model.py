"""The content of definitions as immutable values: dialects, messages, fields, enums, entries and parameters.

Names follow the developer guide. The `type` of a field is the C name of its element (`uint8_t`, `char`);
`array_length` is 0 for a single value. Optional texts are empty strings if absent, and optional numbers are
None. `line` is the line in the XML file, for error texts: it is 0 in tables.
Values computed from the fields of a message (offsets, lengths, CRC_EXTRA) are set by `layout.assign_offsets`,
never by hand.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple, TypeAlias

Number: TypeAlias = int | float

#: Size of an element in bytes, by type name.
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


class Replacement(NamedTuple):
    """A deprecation: since when a message, enum or entry should not be used, and its replacement."""

    since: str = ""
    replaced_by: str = ""
    description: str = ""


class FieldDefinition(NamedTuple):
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
    line: int = 0

    @property
    def size(self) -> int:
        """Size of the field in the payload, in bytes."""
        return TYPE_SIZES[self.type] * (self.array_length or 1)

    @property
    def is_integer(self) -> bool:
        """True if the elements are integers, which may have an enum."""
        return self.type not in ("float", "double", "char")

    @property
    def factor(self) -> float:
        """Factor that converts a raw value to `units`."""
        if not self.multiplier:
            return 1.0
        numerator, _, denominator = self.multiplier.partition("/")
        return float(numerator) / float(denominator or 1)

    @property
    def value_range(self) -> tuple[Number, Number] | None:
        """Minimum and maximum of the wire type, or None for text."""
        if self.type == "char":
            return None
        if self.type in ("float", "double"):
            limit = 3.4028234663852886e38 if self.type == "float" else 1.7976931348623157e308
            return -limit, limit
        bits = TYPE_SIZES[self.type] * 8
        return (0, 2**bits - 1) if self.type.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


class _Message(NamedTuple):
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
    line: int = 0


class MessageDefinition(_Message):
    """One message, its fields in the order of the definition."""

    @cached_property
    def wire_order(self) -> tuple[FieldDefinition, ...]:
        """The fields in the order of the payload."""
        return tuple(sorted(self.fields, key=lambda item: item.offset))

    @cached_property
    def by_name(self) -> dict[str, FieldDefinition]:
        """The fields by name."""
        return {item.name: item for item in self.fields}

    def field(self, name: str) -> FieldDefinition:
        """Return the field of a name; raises KeyError if there is none."""
        return self.by_name[name]


class EnumParam(NamedTuple):
    """One of the seven parameters of a command."""

    index: int  # type: ignore[assignment]  # (hides the method of tuples)
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


class EnumEntry(NamedTuple):
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
    automatic: bool = False
    line: int = 0


class EnumDefinition(NamedTuple):
    """A set of named values; `bitmask` if they are flags."""

    name: str
    entries: tuple[EnumEntry, ...]
    bitmask: bool = False
    deprecated: Replacement | None = None
    superseded: Replacement | None = None
    wip: bool = False
    wip_since: str = ""
    description: str = ""
    line: int = 0

    def entry(self, value: int) -> EnumEntry | None:
        """Return the entry of a value, or None."""
        return next((entry for entry in self.entries if entry.value == value), None)


class _Dialect(NamedTuple):
    name: str
    version: int | None
    number: int | None
    includes: tuple[str, ...]
    messages: tuple[MessageDefinition, ...]
    enums: tuple[EnumDefinition, ...]
    path: str = ""
    include_lines: tuple[int, ...] = ()


class DialectDefinition(_Dialect):
    """Messages and enums of one file, or of a file with all its includes.

    `includes` are the file names as written in the file. Definitions are compared by identity, so that they
    are quick keys of caches.
    """

    __eq__ = object.__eq__
    __ne__ = object.__ne__
    __hash__ = object.__hash__

    @cached_property
    def messages_by_name(self) -> dict[str, MessageDefinition]:
        """The messages by name."""
        return {message.name: message for message in self.messages}

    @cached_property
    def enums_by_name(self) -> dict[str, EnumDefinition]:
        """The enums by name."""
        return {enum.name: enum for enum in self.enums}
