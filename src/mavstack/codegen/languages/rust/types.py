"""Names, types and expressions of Rust."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.codegen.identifiers import distinct, enum_members, type_names
from mavstack.codegen.message_facts import enum_numbers, field_description, message_facts
from mavstack.codegen.templates import one_line, string_literal

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.codegen.library import Library
    from mavstack.dialects.model import FieldDefinition, MessageDefinition

_WORDS: Final = """
Self abstract as async await become box break const continue crate do dyn else enum extern false final fn for
gen if impl in let loop macro match mod move mut override priv pub ref return self static struct super trait
true try type typeof union unsafe unsized use virtual where while yield
"""
RESERVED_WORDS: Final = frozenset(_WORDS.split())
#: Types of the crate and of Rust that generated message and enum modules use, and the variants of `Option`.
_TYPES: Final = frozenset(
    {
        *(
            "Decode",
            "Default",
            "Encode",
            "FieldType",
            "From",
            "MessageInfo",
            "None",
            "Option",
            "Self",
            "Some",
        ),
        *("Text", "Wire"),
    }
)
#: Constants and methods of enums and bitmasks.
_MEMBERS: Final = frozenset({"ENTRIES", "contains", "insert", "intersects", "is_empty", "name", "remove"})
_SNAKE: Final = re.compile(r"_?[a-z0-9]+(_[a-z0-9]+)*_?")

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
    return f"{name}_" if name in RESERVED_WORDS or not name.strip("_") else name


class EnumType(NamedTuple):
    """The struct of an enum.

    Attributes:
        name: Name of the struct.
        number: Type of its number.
    """

    name: str
    number: str


def message_types(library: Library) -> dict[str, str]:
    """Return the names of the structs of all messages, by the name of the message."""
    return type_names((message.name for message in library.messages), _TYPES | RESERVED_WORDS)


def enum_types(library: Library) -> dict[str, EnumType]:
    """Return the structs of all enums, by the name of the enum; none has the name of a message's struct."""
    taken = _TYPES | RESERVED_WORDS | frozenset(message_types(library).values())
    names = type_names((enum.name for enum in library.enums), taken)
    return {
        enum: EnumType(names[enum], f"{'i' if number.signed else 'u'}{number.bits}")
        for enum, number in enum_numbers(library).items()
    }


def enum_values(library: Library, types: dict[str, EnumType]) -> Iterable[dict[str, object]]:
    """Yield the values for the template of each enum."""
    members = enum_members(library)
    for enum in library.enums:
        short = members[enum.name]
        official = dict(zip(short, distinct(short.values(), RESERVED_WORDS | _MEMBERS), strict=True))
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


def message_values(message: MessageDefinition, name: str, types: dict[str, EnumType]) -> dict[str, object]:
    """Return the values for the template of a message."""
    fields = [field_values(item, types) for item in message.fields]
    enums = sorted({types[item.enum].name for item in message.fields if item.enum})
    wire = ["get", "put", "resize", *(["Text"] if any(_is_text(item) for item in message.fields) else [])]
    return {
        **message_facts(message),
        "type": name,
        "module": identifier(message.name.lower()),
        "doc": _doc(f"`{message.name}`.", message.description),
        "enums": _use_list(enums) if enums else "",
        "wire": _use_list(sorted(wire, key=str.swapcase)),
        "odd_names": not all(_SNAKE.fullmatch(identifier(item.name)) for item in message.fields),
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
        "doc": field_description(item, _escape),
        "info": f'field({arguments}({string_literal(item.units)}, "{item.enum}"), {extension})',
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
