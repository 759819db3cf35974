"""Fields in TypeScript: the type of a property, the call that reads it and the call that writes it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from mavstack.dialects.model import EnumDefinition, FieldDefinition

#: The readers and writers of the runtime, by the name of a type.
FUNCTIONS: Final = {
    "char": "text",
    "int8_t": "i8",
    "uint8_t": "u8",
    "int16_t": "i16",
    "uint16_t": "u16",
    "int32_t": "i32",
    "uint32_t": "u32",
    "int64_t": "i64",
    "uint64_t": "u64",
    "float": "f32",
    "double": "f64",
}
WIDE: Final = frozenset({"int64_t", "uint64_t"})


@dataclass(frozen=True, slots=True)
class Property:
    """A field as a property of a class.

    Attributes:
        name: Name of the property.
        field: The field.
        type: Type of the value.
        function: Name of the reader and of the writer.
        read: Expression of the getter.
        write: Statement of the writer.
        info: The object that describes the field.
    """

    name: str
    field: FieldDefinition
    type: str
    function: str
    read: str
    write: str
    info: str


def make_property(
    field: FieldDefinition, name: str, enum: str, definition: EnumDefinition | None, version: int
) -> Property:
    """Return the property of a field.

    Args:
        field: The field.
        name: Name of the property.
        enum: Name of the enum in TypeScript, or an empty string.
        definition: The enum, or None.
        version: Value of the protocol version, if the field holds it.
    """
    function, length = _function(field)
    at = f" + {field.offset}" if field.offset else ""
    more = f", {length}" if length else ""
    optional = f" ?? {_default(field, version)}" if field.extension or field.protocol_version else ""
    return Property(
        name=name,
        field=field,
        type=_type(field, enum, definition),
        function=function,
        read=f"read.{function}(this._view, this._start{at}, this._end{more})",
        write=f'write.{function}(view, at{at}{more}, fields.{name}{optional}, "{name}");',
        info=_info(field, name),
    )


def _function(field: FieldDefinition) -> tuple[str, int]:
    """Return the name of the reader and writer, and the length that it takes; 0 for a single number."""
    if field.type == "char":
        return "text", max(field.array_length, 1)
    if not field.array_length:
        return FUNCTIONS[field.type], 0
    return ("bytes" if field.type == "uint8_t" else f"{FUNCTIONS[field.type]}Array"), field.array_length


def _type(field: FieldDefinition, enum: str, definition: EnumDefinition | None) -> str:
    if field.type == "char":
        return "string"
    number = "bigint" if field.type in WIDE else "number"
    if field.array_length:
        return "Uint8Array" if field.type == "uint8_t" else f"readonly {number}[]"
    if definition is None or not field.is_integer:
        return number
    if definition.bitmask or number == "bigint":
        return enum
    return f"Open<{enum}>"


def _default(field: FieldDefinition, version: int) -> str:
    if field.protocol_version:
        return str(version)
    if field.type == "char":
        return '""'
    if field.array_length:
        return "[]"
    return "0n" if field.type in WIDE else "0"


def _info(field: FieldDefinition, name: str) -> str:
    parts = [
        f'name: "{field.name}", property: "{name}", type: "{field.type}"',
        f"offset: {field.offset}, arrayLength: {field.array_length}",
    ]
    if field.units:
        parts.append(f'units: "{field.units}"')
    if field.multiplier:
        parts.append(f"multiplier: {field.factor!r}")
    if field.enum:
        parts.append(f'enum: "{field.enum}"')
    if field.extension:
        parts.append("extension: true")
    return f"{{ {', '.join(parts)} }}"


def is_wide(uses: set[str]) -> bool:
    """Return whether the values of an enum are bigints: it is used by 64-bit fields alone."""
    return bool(uses) and uses <= WIDE
