"""The C# types of fields, and the statements that read and write them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from mavstack.dialects.model import FieldDefinition

#: C# type, and name in the methods of `Wire`, by wire type.
TYPES: Final = {
    "char": ("string", "Char"),
    "int8_t": ("sbyte", "Int8"),
    "uint8_t": ("byte", "UInt8"),
    "int16_t": ("short", "Int16"),
    "uint16_t": ("ushort", "UInt16"),
    "int32_t": ("int", "Int32"),
    "uint32_t": ("uint", "UInt32"),
    "int64_t": ("long", "Int64"),
    "uint64_t": ("ulong", "UInt64"),
    "float": ("float", "Single"),
    "double": ("double", "Double"),
}

#: Arrays: name in the methods of `Wire`, C# type and size of an element; bytes have separate methods.
ARRAYS: Final = (
    ("Int8", "sbyte", 1),
    ("Int16", "short", 2),
    ("UInt16", "ushort", 2),
    ("Int32", "int", 4),
    ("UInt32", "uint", 4),
    ("Int64", "long", 8),
    ("UInt64", "ulong", 8),
    ("Single", "float", 4),
    ("Double", "double", 8),
)


class Access(NamedTuple):
    """A field in C#: its type, initial value, and the statements that decode and encode it."""

    type: str
    initial: str
    decode: str
    encode: str


def access(field: FieldDefinition, name: str, enum: str | None) -> Access:
    """Return the C# type and the statements of a field.

    Args:
        field: The field.
        name: Its C# name.
        enum: The enum of a single value, or None; the elements of arrays are numbers.
    """
    element, wire = TYPES[field.type]
    place = f"b, o + {field.offset}" if field.offset else "b, o"
    count = max(field.array_length, 1)
    if field.type == "char":
        return _with_length("string", ' = "";', "Text", name, place, count)
    if field.array_length:
        method = "Bytes" if element == "byte" else f"{wire}Array"
        return _with_length(f"{element}[]", f" = new {element}[{count}];", method, name, place, count)
    if enum and field.is_integer:
        read, written = f"({enum})Wire.Read{wire}({place})", f"unchecked(({element}){name})"
        return Access(enum, "", f"{name} = unchecked({read});", f"Wire.Write{wire}({place}, {written});")
    initial = " = Dialect.Version;" if field.protocol_version else ""
    return Access(
        element, initial, f"{name} = Wire.Read{wire}({place});", f"Wire.Write{wire}({place}, {name});"
    )


def _with_length(type_name: str, initial: str, method: str, name: str, place: str, count: int) -> Access:
    return Access(
        type_name,
        initial,
        f"{name} = Wire.Read{method}({place}, {count});",
        f"Wire.Write{method}({place}, {name}, {count});",
    )
