"""The Go types of fields, and the statements that read and write them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.dialects.model import TYPE_SIZES

if TYPE_CHECKING:
    from mavstack.dialects.model import FieldDefinition

#: Go types of single values and elements.
TYPES: Final = {
    "char": "string",
    "int8_t": "int8",
    "uint8_t": "uint8",
    "int16_t": "int16",
    "uint16_t": "uint16",
    "int32_t": "int32",
    "uint32_t": "uint32",
    "int64_t": "int64",
    "uint64_t": "uint64",
    "float": "float32",
    "double": "float64",
}


class Access(NamedTuple):
    """A field in Go: its type, and the statements that decode and encode it."""

    go: str
    decode: list[str]
    encode: list[str]


def access(field: FieldDefinition, name: str, enum: str | None) -> Access:
    """Return the Go type and the statements of a field.

    Args:
        field: The field.
        name: Its Go name.
        enum: The type of its enum, or None.
    """
    start, end = field.offset, field.offset + field.size
    element = TYPES[field.type]
    if field.type == "char":
        return Access(
            "string",
            [f"m.{name} = textOf(b[{start}:{end}])"],
            [
                f'if err := putText(b[{start}:{end}], m.{name}, "{field.name}"); err != nil {{',
                "\treturn err",
                "}",
            ],
        )
    if field.protocol_version and element == "uint8":
        written = f"b[{start}] = protocolVersion(m.{name})"
        return Access(element, [f"m.{name} = b[{start}]"], [written])
    go = enum if enum and field.is_integer else element
    size = TYPE_SIZES[field.type]
    if not field.array_length:
        return Access(
            go,
            [f"m.{name} = {_read(field.type, go, _place(start, size))}"],
            [_write(field.type, go, _place(start, size), f"m.{name}")],
        )
    array = f"[{field.array_length}]{go}"
    if go == "uint8":
        return Access(
            array, [f"copy(m.{name}[:], b[{start}:{end}])"], [f"copy(b[{start}:{end}], m.{name}[:])"]
        )
    index = f"{start}+{size}*i" if size > 1 else f"{start}+i"
    place = f"{index.removeprefix('0+')}:" if size > 1 else index.removeprefix("0+")
    if size > 1 and start == 0:
        place = f"{size}*i:"
    loop = f"for i := range m.{name} {{"
    value = f"m.{name}[i]"
    return Access(
        array,
        [loop, f"\t{value} = {_read(field.type, go, place)}", "}"],
        [loop, f"\t{_write(field.type, go, place, value)}", "}"],
    )


def _place(start: int, size: int) -> str:
    return f"{start}:" if size > 1 else f"{start}"


def _read(wire: str, go: str, place: str) -> str:
    """Return the expression that reads a value; the compiler makes one load of it."""
    size = TYPE_SIZES[wire]
    raw = f"b[{place}]" if size == 1 else f"binary.LittleEndian.Uint{8 * size}(b[{place}])"
    if wire in ("float", "double"):
        return f"math.Float{8 * size}frombits({raw})"
    if wire.startswith("int") and go != TYPES[wire]:  # sign-extends to a wider enum
        raw = f"{TYPES[wire]}({raw})"
    return raw if go == f"uint{8 * size}" else f"{go}({raw})"


def _write(wire: str, go: str, place: str, value: str) -> str:
    size = TYPE_SIZES[wire]
    if wire in ("float", "double"):
        value = f"math.Float{8 * size}bits({value})"
    elif go != f"uint{8 * size}":
        value = f"uint{8 * size}({value})"
    if size == 1:
        return f"b[{place}] = {value}"
    return f"binary.LittleEndian.PutUint{8 * size}(b[{place}], {value})"


def imports(fields: tuple[FieldDefinition, ...]) -> list[str]:
    """Return the packages that the statements of fields need."""
    names = []
    if any(TYPE_SIZES[field.type] > 1 for field in fields):
        names.append("encoding/binary")
    if any(field.type in ("float", "double") for field in fields):
        names.append("math")
    return names


def field_type(field: FieldDefinition) -> str:
    """Return the constant of the type of an element."""
    return f"Type{field.type.removesuffix('_t').capitalize()}"
