"""Names, types and expressions of Swift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.codegen.enum_names import entry_names
from mavstack.codegen.templates import camel_case, one_line
from mavstack.dialects.model import TYPE_SIZES
from mavstack.dialects.names import class_name

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.codegen.library import Library
    from mavstack.dialects.model import EnumDefinition, FieldDefinition, MessageDefinition

_WORDS: Final = """
Any Protocol Self Type as associatedtype async await break case catch class continue default defer deinit do
else enum extension fallthrough false fileprivate for func guard if import in init inout internal is let nil
open operator precedencegroup private protocol public repeat rethrows return self static struct subscript
super switch throw throws true try typealias var where while
"""
RESERVED_WORDS: Final = frozenset(_WORDS.split())
#: Names of the runtime's types and of those of the standard library that it uses.
_TYPES: Final = """
Array ArraySlice Bool Checksum CustomStringConvertible Dialect Double EncodeError Encoder Error
ExpressibleByStringLiteral FieldDefinition FixedWidthInteger Float Hashable Header Int Int16 Int32 Int64 Int8
Message MessageDefinition MessageEncoder OptionSet Optional Packet Parser PayloadReader PayloadWriter
RawRepresentable Refusal SHA256 Sendable Sequence Signer SigningKey SigningTime Statistics String Text UInt16
UInt32 UInt64 UInt8 UTF8 Verifier Version WritableKeyPath
"""
_TAKEN_TYPES: Final = RESERVED_WORDS | frozenset(_TYPES.split())
#: Names that an enum's struct uses itself.
_TAKEN_ENTRIES: Final = RESERVED_WORDS | {"description", "hashValue", "rawValue"}

#: Types of values by their type in the definition.
WIRE_TYPES: Final = {
    "char": "UInt8",
    "uint8_t": "UInt8",
    "int8_t": "Int8",
    "uint16_t": "UInt16",
    "int16_t": "Int16",
    "uint32_t": "UInt32",
    "int32_t": "Int32",
    "uint64_t": "UInt64",
    "int64_t": "Int64",
    "float": "Float",
    "double": "Double",
}


@dataclass(frozen=True)
class EnumType:
    """The struct of an enum.

    Attributes:
        name: Name of the struct.
        number: Type of its raw value.
    """

    name: str
    number: str


def type_name(official: str) -> str:
    """Return the name of the struct of a message or enum."""
    name = class_name(official)
    return f"{name}_" if name in _TAKEN_TYPES else name


def identifier(name: str) -> str:
    """Return the name of the property of a field."""
    camel = camel_case(name)
    camel = f"_{camel}" if not camel or camel[0].isdigit() else camel
    return f"{camel}_" if camel in RESERVED_WORDS else camel


def properties(message: MessageDefinition) -> dict[str, str]:
    """Return the names of the properties by those of the fields; equal ones keep their form."""
    names = {item.name: identifier(item.name) for item in message.fields}
    values = list(names.values())
    return {name: found if values.count(found) == 1 else f"{name}_" for name, found in names.items()}


def enum_types(library: Library) -> dict[str, EnumType]:
    """Return the structs of all enums, by the name of the enum.

    The raw value is as wide as the widest field of the enum, and wide enough for all entries. An enum with
    the name of a message gets the ending `Enum`.
    """
    widths: dict[str, int] = {}
    for message in library.messages:
        for item in message.fields:
            if item.enum:
                widths[item.enum] = max(widths.get(item.enum, 1), TYPE_SIZES[item.type])
    messages = {type_name(message.name) for message in library.messages}
    names = {enum.name: type_name(enum.name) for enum in library.enums}
    return {
        enum.name: EnumType(
            f"{names[enum.name]}Enum" if names[enum.name] in messages else names[enum.name],
            _number(enum, widths),
        )
        for enum in library.enums
    }


def _number(enum: EnumDefinition, widths: dict[str, int]) -> str:
    values = [entry.value for entry in enum.entries]
    signed = any(value < 0 for value in values)
    bits = max((value.bit_length() for value in values), default=0) + signed
    width = max(widths.get(enum.name, 4), next(size for size in (1, 2, 4, 8) if size * 8 >= bits))
    return f"{'' if signed else 'U'}Int{width * 8}"


def enum_values(library: Library, types: dict[str, EnumType]) -> Iterable[dict[str, object]]:
    """Yield the values for the template of each enum."""
    short = entry_names(library)
    for enum in library.enums:
        names = _entry_identifiers(short[enum.name])
        first = {entry.value: entry.name for entry in reversed(enum.entries)}
        found = types[enum.name]
        yield {
            "official": enum.name,
            "type": found.name,
            "repr": found.number,
            "bitmask": enum.bitmask,
            "doc": one_line(enum.description),
            "names": [{"value": value, "official": name} for value, name in sorted(first.items())],
            "entries": [
                {
                    "name": names[entry.name],
                    # The compiler warns of an option set that is made of the raw value 0.
                    "value": "[]"
                    if enum.bitmask and not entry.value
                    else f"{found.name}(rawValue: {entry.value})",
                    "doc": " ".join([f"`{entry.name}`", one_line(entry.description)]).strip(),
                }
                for entry in enum.entries
            ],
        }


def _entry_identifiers(short: dict[str, str]) -> dict[str, str]:
    """Return the names of the constants by those of the entries."""
    names: dict[str, str] = {}
    for entry, name in short.items():
        words = name.strip("_").lower()
        camel = camel_case(words)
        camel = f"_{camel}" if not camel or camel[0].isdigit() else camel
        camel = f"{camel}_" if camel in _TAKEN_ENTRIES else camel
        names[entry] = camel if camel not in names.values() else entry
    return names


def message_values(message: MessageDefinition, types: dict[str, EnumType]) -> dict[str, object]:
    """Return the values for the template of a message."""
    names = properties(message)
    return {
        "type": type_name(message.name),
        "name": message.name,
        "id": message.id,
        "length": message.length,
        "base_length": message.base_length,
        "crc_extra": message.crc_extra,
        "doc": one_line(message.description),
        "fields": [_field_values(item, names[item.name], types) for item in message.fields],
    }


def _field_values(item: FieldDefinition, name: str, types: dict[str, EnumType]) -> dict[str, object]:
    enum = types[item.enum] if item.enum else None
    element = enum.name if enum else WIRE_TYPES[item.type]
    zero = f"{element}(rawValue: 0)" if enum else "0"
    if item.type == "char" and item.array_length:
        element, zero = "Text", "Text()"
    elif item.array_length:
        element, zero = f"[{element}]", f"[{element}](repeating: {zero}, count: {item.array_length})"
    decode, encode = _conversions(item, name, enum)
    return {
        "name": name,
        "type": element,
        "zero": zero,
        "decode": decode,
        "encode": encode,
        "doc": _field_doc(item),
        "definition": _definition(item),
    }


def _conversions(item: FieldDefinition, name: str, enum: EnumType | None) -> tuple[str, str]:
    """Return the expression that decodes a field, and the arguments that encode it."""
    wire, offset, count = WIRE_TYPES[item.type], item.offset, item.array_length
    kind = wire.lower() if wire in ("Float", "Double") else "integer"
    if item.type == "char" and count:
        return f"reader.text({offset}, {count})", f"self.{name}, {offset}, {count}"
    place = f"{offset}, {count}" if count else f"{offset}"
    read = f"reader.{kind}{'s' if count else ''}({place})"
    if not enum:
        return read, f"self.{name}, {place}"
    if count:
        element = f"{enum.name}(rawValue: {enum.number}(truncatingIfNeeded: $0))"
        encode = f"self.{name}.map {{ {wire}(truncatingIfNeeded: $0.rawValue) }}, {place}"
        return f"({read} as [{wire}]).map {{ {element} }}", encode
    if wire == enum.number:
        return f"{enum.name}(rawValue: {read})", f"self.{name}.rawValue, {place}"
    number = f"{enum.number}(truncatingIfNeeded: {read} as {wire})"
    return f"{enum.name}(rawValue: {number})", f"{wire}(truncatingIfNeeded: self.{name}.rawValue), {place}"


def _field_doc(item: FieldDefinition) -> str:
    """Return the description, and type, units and extension."""
    array = f"[{item.array_length}]" if item.array_length else ""
    facts = [f"`{item.type}{array}`"]
    facts += [f"in {one_line(item.units)}"] if item.units else []
    facts += [f"times {item.multiplier}"] if item.multiplier else []
    facts += [f"`{item.invalid}` if unknown"] if item.invalid else []
    facts += ["extension"] if item.extension else []
    text = one_line(item.description)
    return f"{text} ({', '.join(facts)})" if text else f"{', '.join(facts)}."


def _definition(item: FieldDefinition) -> str:
    parts = [f'"{item.name}", "{item.type}", {item.array_length}, at: {item.offset}']
    units = one_line(item.units).replace("\\", "\\\\").replace('"', '\\"')
    parts += [f'units: "{units}"'] if units else []
    parts += [f'enumeration: "{item.enum}"'] if item.enum else []
    parts += ["isExtension: true"] if item.extension else []
    return f"FieldDefinition({', '.join(parts)})"
