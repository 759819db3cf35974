"""Facts of messages and enums that several languages need in the same form."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from mavstack.codegen.templates import one_line
from mavstack.dialects.model import TYPE_SIZES

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.codegen.library import Library
    from mavstack.dialects.model import EnumDefinition, FieldDefinition, MessageDefinition


class EnumNumber(NamedTuple):
    """The integers that hold the values of an enum.

    Attributes:
        signed: True if an entry is negative or a field of the enum is signed.
        bits: Number of bits: 8, 16, 32 or 64.
    """

    signed: bool
    bits: int


def message_facts(message: MessageDefinition) -> dict[str, Any]:
    """Return the values of a message that each language has in its tables."""
    return {
        "name": message.name,
        "id": message.id,
        "length": message.length,
        "base_length": message.base_length,
        "crc_extra": message.crc_extra,
    }


def table_row(message: MessageDefinition) -> str:
    """Return id and facts of a message in a table of numbers: 1, CRC_EXTRA and the two lengths in 25 bits."""
    facts = 1 << 24 | message.crc_extra << 16 | message.base_length << 8 | message.length
    return f"{message.id}, 0x{facts:07X},"


def field_description(item: FieldDefinition, escape: Callable[[str], str]) -> str:
    """Return the description of a field with its type, unit and extension, in Markdown.

    Args:
        item: The field.
        escape: Makes a text plain in a comment of the language.
    """
    array = f"[{item.array_length}]" if item.array_length else ""
    facts = [f"`{item.type}{array}`"]
    facts += [f"in {escape(item.units)}"] if item.units else []
    facts += [f"times {escape(item.multiplier)}"] if item.multiplier else []
    facts += [f"`{_code(item.invalid)}` if unknown"] if item.invalid else []
    facts += ["extension"] if item.extension else []
    text = escape(item.description)
    return f"{text} ({', '.join(facts)})" if text else f"{', '.join(facts)}."


def _code(text: str) -> str:
    return one_line(text.replace("`", "'"))


def enum_numbers(library: Library) -> dict[str, EnumNumber]:
    """Return the integers of all enums: each holds all entries, and all values of the fields that use it.

    An integer is as wide as the widest field. It is signed if an entry is negative or a field is signed, and
    then wider than the fields that are not, up to 64 bits.
    """
    types: dict[str, set[str]] = {}
    for message in library.messages:
        for item in message.fields:
            if item.enum and item.is_integer:
                types.setdefault(item.enum, set()).add(item.type)
    return {enum.name: _number(enum, types.get(enum.name, {"uint32_t"})) for enum in library.enums}


def _number(enum: EnumDefinition, types: set[str]) -> EnumNumber:
    values = [entry.value for entry in enum.entries]
    signed = any(value < 0 for value in values) or any(name.startswith("int") for name in types)
    # In two's complement, a negative value needs as many bits as its complement.
    needed = [max((value if value >= 0 else ~value for value in values), default=0).bit_length() + signed]
    needed += [8 * TYPE_SIZES[name] + (signed and not name.startswith("int")) for name in types]
    return EnumNumber(signed, next((size for size in (8, 16, 32) if size >= max(needed)), 64))
