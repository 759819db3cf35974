"""Names, types and expressions of Rust."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.codegen.enum_names import entry_names
from mavstack.codegen.templates import one_line
from mavstack.dialects.model import TYPE_SIZES
from mavstack.dialects.names import class_name

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.codegen.library import Library
    from mavstack.dialects.model import EnumDefinition, FieldDefinition, MessageDefinition

_WORDS: Final = """
Self abstract as async await become box break const continue crate do dyn else enum extern false final fn for
gen if impl in let loop macro match mod move mut override priv pub ref return self static struct super trait
true try type typeof union unsafe unsized use virtual where while yield
"""
RESERVED_WORDS: Final = frozenset(_WORDS.split())

#: Types of values by their type in the definition.
WIRE_TYPES: Final = {
    "char": "u8",
    "uint8_t": "u8",
    "int8_t": "i8",
    "uint16_t": "u16",
    "int16_t": "i16",
    "uint32_t": "u32",
    "int32_t": "i32",
    "uint64_t": "u64",
    "int64_t": "i64",
    "float": "f32",
    "double": "f64",
}


def identifier(name: str) -> str:
    """Return a name of the definition as the name of a field or module."""
    name = f"_{name}" if name[:1].isdigit() else name
    return f"{name}_" if name in RESERVED_WORDS else name


@dataclass(frozen=True)
class EnumType:
    """The struct of an enum.

    Attributes:
        name: Name of the struct.
        number: Type of its number.
    """

    name: str
    number: str


def enum_types(library: Library) -> dict[str, EnumType]:
    """Return the structs of all enums, by the name of the enum.

    The number is as wide as the widest field of the enum, and wide enough for all entries.
    """
    widths: dict[str, int] = {}
    for message in library.messages:
        for item in message.fields:
            if item.enum:
                widths[item.enum] = max(widths.get(item.enum, 1), TYPE_SIZES[item.type])
    return {enum.name: EnumType(class_name(enum.name), _number(enum, widths)) for enum in library.enums}


def _number(enum: EnumDefinition, widths: dict[str, int]) -> str:
    values = [entry.value for entry in enum.entries]
    signed = any(value < 0 for value in values)
    bits = max((value.bit_length() for value in values), default=0) + signed
    width = max(widths.get(enum.name, 4), next(size for size in (1, 2, 4, 8) if size * 8 >= bits))
    return f"{'i' if signed else 'u'}{width * 8}"


def enum_values(library: Library, types: dict[str, EnumType]) -> Iterable[dict[str, object]]:
    """Yield the values for the template of each enum."""
    names = entry_names(library, {"ENTRIES"})
    for enum in library.enums:
        official = names[enum.name]
        yield {
            "type": types[enum.name].name,
            "module": identifier(enum.name.lower()),
            "repr": types[enum.name].number,
            "macro": "bitmask" if enum.bitmask else "enumeration",
            "doc": _doc(f"`{enum.name}`.", enum.description),
            "entries": [
                {
                    "name": official[entry.name],
                    "value": entry.value,
                    "doc": " ".join(_doc(f"`{entry.name}`.", entry.description)),
                }
                for entry in enum.entries
            ],
        }


def message_values(message: MessageDefinition, types: dict[str, EnumType]) -> dict[str, object]:
    """Return the values for the template of a message."""
    fields = [field_values(item, types) for item in message.fields]
    enums = sorted({types[item.enum].name for item in message.fields if item.enum})
    wire = ["get", "put", "resize", *(["Text"] if any(_is_text(item) for item in message.fields) else [])]
    return {
        "type": class_name(message.name),
        "module": identifier(message.name.lower()),
        "name": message.name,
        "id": message.id,
        "length": message.length,
        "base_length": message.base_length,
        "crc_extra": message.crc_extra,
        "doc": _doc(f"`{message.name}`.", message.description),
        "enums": _use_list(enums) if enums else "",
        "wire": _use_list(sorted(wire, key=str.swapcase)),
        "odd_names": any(item.name != item.name.lower() for item in message.fields),
        "fields": fields,
    }


def field_values(item: FieldDefinition, types: dict[str, EnumType]) -> dict[str, object]:
    """Return the values for the templates of a field."""
    name = identifier(item.name)
    kind = "Char" if item.type == "char" else WIRE_TYPES[item.type].upper()
    enum = types[item.enum] if item.enum else None
    wire, field_type = WIRE_TYPES[item.type], _field_type(item, enum)
    get, put = f"get(payload, {item.offset})", f"self.{name}"
    if enum and wire != enum.number:
        get, put = _conversions(item, enum, wire, get, put)
    arguments = f'"{item.name}", (FieldType::{kind}, {item.array_length}), {item.offset}, '
    extension = "true" if item.extension else "false"
    return {
        "name": name,
        "type": field_type,
        "offset": item.offset,
        "decode": get,
        "encode": put,
        "doc": _field_doc(item),
        "info": f'field({arguments}("{one_line(item.units)}", "{item.enum}"), {extension})',
    }


def _conversions(item: FieldDefinition, enum: EnumType, wire: str, get: str, put: str) -> tuple[str, str]:
    """Return the expressions for a field whose wire type is not that of its enum."""
    array = f"[{wire}; {item.array_length}]" if item.array_length else wire
    typed = get.replace("get", f"get::<{array}>")
    if not item.array_length:
        return f"{enum.name}({typed} as {enum.number})", f"({put}.0 as {wire})"
    from_wire, to_wire = f"{enum.name}(value as {enum.number})", f"value.0 as {wire}"
    return f"{typed}.map(|value| {from_wire})", f"{put}.map(|value| {to_wire})"


def _field_type(item: FieldDefinition, enum: EnumType | None) -> str:
    if _is_text(item):
        return f"Text<{item.array_length}>"
    element = enum.name if enum else WIRE_TYPES[item.type]
    return f"[{element}; {item.array_length}]" if item.array_length else element


def _is_text(item: FieldDefinition) -> bool:
    return item.type == "char" and item.array_length > 0


def _field_doc(item: FieldDefinition) -> str:
    """Return the description, and type, units and extension."""
    array = f"[{item.array_length}]" if item.array_length else ""
    facts = [f"`{item.type}{array}`"]
    facts += [f"in {one_line(item.units)}"] if item.units else []
    facts += [f"times {item.multiplier}"] if item.multiplier else []
    facts += [f"`{item.invalid}` if unknown"] if item.invalid else []
    facts += ["extension"] if item.extension else []
    text = _escape(item.description)
    return f"{text} ({', '.join(facts)})" if text else f"{', '.join(facts)}."


def _doc(first: str, description: str) -> list[str]:
    """Return the lines of a documentation comment."""
    text = _escape(description)
    return [text, "", first] if text else [first]


def _escape(text: str) -> str:
    """Return a text in which Markdown has nothing to interpret."""
    text = one_line(text)
    for special in "\\[]<>`*_":
        text = text.replace(special, f"\\{special}")
    return text


def _use_list(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{{{', '.join(names)}}}"
