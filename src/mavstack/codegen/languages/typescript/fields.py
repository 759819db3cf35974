"""Fields in TypeScript: the type of a property, the call that reads it and the call that writes it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.codegen.templates import string_literal

if TYPE_CHECKING:
    from mavstack.dialects.model import EnumDefinition, FieldDefinition

#: The functions of the runtime that read and write a value, by type.
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


class Property(NamedTuple):
    """A field as a property of a class.

    Attributes:
        name: Name of the property.
        field: The field.
        type: Type of the value.
        read: Expression of the getter.
        write: Statement of the writer.
        info: The object that describes the field.
    """

    name: str
    field: FieldDefinition
    type: str
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
    function, value_type, length = _access(field)
    if definition is not None and field.is_integer and not length:
        value_type = enum if definition.bitmask or value_type == "bigint" else f"Open<{enum}>"
    at = f" + {field.offset}" if field.offset else ""
    more = f", {length}" if length else ""
    optional = f" ?? {_default(field, version)}" if field.extension or field.protocol_version else ""
    return Property(
        name,
        field,
        value_type,
        f"read.{function}(this._view, this._start{at}, this._end{more})",
        f'write.{function}(view, at{at}{more}, fields.{name}{optional}, "{name}");',
        _info(field, name),
    )


def _access(field: FieldDefinition) -> tuple[str, str, int]:
    """Return the name of reader and writer, the type, and their length; 0 for a single number."""
    function, length = FUNCTIONS[field.type], field.array_length
    if function == "text":
        return function, "string", length or 1
    number = "bigint" if field.type in WIDE else "number"
    if not length:
        return function, number, 0
    if function == "u8":
        return "bytes", "Uint8Array", length
    return f"{function}Array", f"readonly {number}[]", length


def _default(field: FieldDefinition, version: int) -> str:
    if field.protocol_version:
        return str(version)
    if field.type == "char":
        return '""'
    if field.array_length:
        return "[]"
    return "0n" if field.type in WIDE else "0"


def _info(field: FieldDefinition, name: str) -> str:
    names = f'name: "{field.name}", property: "{name}", type: "{field.type}"'
    place = f"offset: {field.offset}, arrayLength: {field.array_length}"
    units = f", units: {string_literal(field.units)}" if field.units else ""
    multiplier = f", multiplier: {field.factor!r}" if field.multiplier else ""
    enum = f', enum: "{field.enum}"' if field.enum else ""
    extension = ", extension: true" if field.extension else ""
    return f"{{ {names}, {place}{units}{multiplier}{enum}{extension} }}"


def is_wide(uses: set[str]) -> bool:
    """Return whether the values of an enum are bigints: it is used by 64-bit fields alone."""
    return bool(uses) and uses <= WIDE
