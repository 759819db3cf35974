"""The Java types of fields, and the expressions that read and write them.

Unsigned types are one size larger, as Java has none: `uint8_t` is `int`, `uint32_t` is `long`; `uint64_t` is
`long` for the unsigned methods of `Long`. An array of bytes is `byte[]`, signed or not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from mavstack.dialects.model import FieldDefinition


class JavaType(NamedTuple):
    """A wire type in Java.

    Attributes:
        single: Java type of a single value.
        element: Java type of an element of an array.
        name: Name of the methods of `Wire` and, in upper case, of the `FieldType`.
    """

    single: str
    element: str
    name: str


TYPES: Final = {
    "char": JavaType("String", "String", "char"),
    "int8_t": JavaType("byte", "byte", "int8"),
    "uint8_t": JavaType("int", "byte", "uint8"),
    "int16_t": JavaType("short", "short", "int16"),
    "uint16_t": JavaType("int", "int", "uint16"),
    "int32_t": JavaType("int", "int", "int32"),
    "uint32_t": JavaType("long", "long", "uint32"),
    "int64_t": JavaType("long", "long", "int64"),
    "uint64_t": JavaType("long", "long", "uint64"),
    "float": JavaType("float", "float", "float32"),
    "double": JavaType("double", "double", "float64"),
}

#: The methods of `Wire` for single values: name, Java type, expressions that read and write.
SCALARS: Final = (
    ("int8", "byte", "b[o]", "b[o] = value"),
    ("uint8", "int", "b[o] & 0xFF", "b[o] = (byte) value"),
    ("int16", "short", "(short) SHORT.get(b, o)", "SHORT.set(b, o, value)"),
    ("uint16", "int", "(short) SHORT.get(b, o) & 0xFFFF", "SHORT.set(b, o, (short) value)"),
    ("int32", "int", "(int) INT.get(b, o)", "INT.set(b, o, value)"),
    ("uint32", "long", "(int) INT.get(b, o) & 0xFFFFFFFFL", "INT.set(b, o, (int) value)"),
    ("int64", "long", "(long) LONG.get(b, o)", "LONG.set(b, o, value)"),
    ("float32", "float", "(float) FLOAT.get(b, o)", "FLOAT.set(b, o, value)"),
    ("float64", "double", "(double) DOUBLE.get(b, o)", "DOUBLE.set(b, o, value)"),
)

#: The methods of `Wire` for arrays: name, Java type, method of an element, size of an element.
ARRAYS: Final = (
    ("int16", "short", "int16", 2),
    ("uint16", "int", "uint16", 2),
    ("int32", "int", "int32", 4),
    ("uint32", "long", "uint32", 4),
    ("int64", "long", "int64", 8),
    ("float32", "float", "float32", 4),
    ("float64", "double", "float64", 8),
)


class Access(NamedTuple):
    """A field in Java: its type, initial value, and the statements that decode and encode it."""

    java: str
    initial: str
    decode: str
    encode: str


def access(field: FieldDefinition, name: str) -> Access:
    """Return the Java type and the statements of a field.

    Args:
        field: The field.
        name: Its Java name.
    """
    java = TYPES[field.type]
    place = f"b, o + {field.offset}" if field.offset else "b, o"
    count = max(field.array_length, 1)
    if field.type == "char":
        return _access("String", ' = ""', "text", name, place, count)
    method = "int64" if field.type == "uint64_t" else java.name
    if field.array_length:
        plural = "bytes" if java.element == "byte" else f"{method}s"
        initial = f" = new {java.element}[{count}]"
        return _access(f"{java.element}[]", initial, plural, name, place, count)
    initial = " = Dialect.VERSION" if field.protocol_version else ""
    return _access(java.single, initial, method, name, place, 0)


def _access(java: str, initial: str, method: str, name: str, place: str, count: int) -> Access:
    length = f", {count}" if count else ""
    return Access(
        java,
        initial,
        f"this.{name} = Wire.{method}({place}{length});",
        f"Wire.{method}({place}, this.{name}{length});",
    )


def field_type(field: FieldDefinition) -> str:
    """Return the constant of `FieldType`."""
    names = {"float": "FLOAT", "double": "DOUBLE"}
    return names.get(field.type, TYPES[field.type].name.upper())
