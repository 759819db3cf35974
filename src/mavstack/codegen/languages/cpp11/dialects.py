"""The parts of a dialect's header: tables of its messages, enums and aliases.

The messages and enums of a file are in its own namespace; those of the files that it includes have aliases
there. An enum to which a file adds entries is complete in its namespace.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.codegen.languages.c.dialects import closure, entry, enum_end, enums
from mavstack.codegen.languages.c.reserved import identifier, namespace
from mavstack.codegen.languages.cpp11.messages import struct_name
from mavstack.codegen.templates import one_line
from mavstack.dialects.model import TYPE_SIZES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.codegen.library import DialectFile, Library
    from mavstack.dialects.model import EnumDefinition, EnumEntry, MessageDefinition

#: Names in the namespace of a dialect, and names of the runtime that its headers use.
_TAKEN: Final = frozenset(
    {"MESSAGE_ENTRIES", "Parser", "Variant", "impl", "mavlink", "msg", "to_variant", "visit"}
)


class DialectParts(NamedTuple):
    """Texts of a dialect for the templates of its headers."""

    name: str
    macro: str
    namespace: str
    version: int
    includes: tuple[str, ...]
    message_files: tuple[str, ...]
    message_count: int
    entries: str
    enums: str
    enum_aliases: str
    message_aliases: str
    cases: str
    types: str


def dialect_parts(library: Library, file: DialectFile) -> DialectParts:
    """Return the texts of the folder of a definition file."""
    files = closure(library, file)
    messages = sorted((message for item in files for message in item.messages), key=lambda item: item.id)
    types = _underlying_types(messages)
    own = [
        (enum.name, _enum(enum, entries, types.get(enum.name, ""))) for enum, entries in enums(library, file)
    ]
    return DialectParts(
        name=file.name,
        macro=namespace(file.name).upper(),
        namespace=namespace(file.name),
        version=library.version,
        includes=file.includes,
        message_files=tuple(message.name.lower() for message in file.messages),
        message_count=len(messages),
        entries=",\n".join(f"    {entry(message)}" for message in messages),
        enums="\n".join(text for _, text in own),
        enum_aliases="".join(_enum_aliases(library, file, {name for name, _ in own})),
        message_aliases="\n".join(
            f"using {namespace(item.name)}::msg::{struct_name(message)};"
            for item in files
            if item is not file
            for message in item.messages
        ),
        cases="\n".join(
            f"    case {item.id}:\n        return impl::call<msg::{struct_name(item)}>(0, packet, visitor);"
            for item in messages
        ),
        types=",\n".join(f"    msg::{struct_name(message)}" for message in messages) or "    std::monostate",
    )


def _underlying_types(messages: Iterable[MessageDefinition]) -> dict[str, str]:
    """Return the largest type of the fields that hold an enum, by the name of the enum."""
    types: dict[str, str] = {}
    for message in messages:
        for field in message.fields:
            if field.enum:
                types[field.enum] = max(types.get(field.enum, field.type), field.type, key=_size)
    return types


def _size(type_name: str) -> tuple[int, bool]:
    return TYPE_SIZES[type_name], type_name.startswith("u")


def _enum(enum: EnumDefinition, entries: tuple[EnumEntry, ...], field_type: str) -> str:
    end = enum_end(entries)
    underlying = _fitting(field_type, min((item.value for item in entries), default=0), end - 1)
    lines = "".join(
        f"    {_entry_name(enum.name, item.name)} = {_value(item.value)},{_note(item.description)}\n"
        for item in entries
    )
    suffix = "ULL" if end > 2**63 - 1 else "LL" if end > 2**31 - 1 else ""
    comment = one_line(enum.description)
    return (
        f"/// {comment or enum.name}\nenum class {enum_name(enum.name)} : {underlying} {{\n{lines}}};\n"
        f"constexpr auto {enum.name}_ENUM_END = {end}{suffix};\n"
    )


def _value(value: int) -> str:
    """Return a number as C++ writes it: neither 2^63 nor -2^63 is a constant without more."""
    if value > 2**63 - 1:
        return f"{value}ULL"
    return f"({value + 1} - 1)" if value == -(2**63) else str(value)


def _fitting(field_type: str, minimum: int, maximum: int) -> str:
    """Return the type of the fields if it holds all values, else the smallest that does."""
    if minimum < 0:
        bits = max(~minimum, maximum).bit_length() + 1
        size = max(
            TYPE_SIZES.get(field_type, 4) * 8, next((item for item in (8, 16, 32) if item >= bits), 64)
        )
        return f"int{size}_t"
    if field_type in ("", "float", "double", "char"):
        return "int32_t" if maximum < 2**31 else "int64_t"
    bits = TYPE_SIZES[field_type] * 8 - (not field_type.startswith("u"))
    return (
        field_type if maximum < 2**bits else f"uint{max(8, 1 << (maximum.bit_length() - 1).bit_length())}_t"
    )


def _entry_name(enum: str, name: str) -> str:
    """Return the name of an entry without the words that it shares with its enum."""
    words, prefix = name.split("_"), enum.split("_")
    shared = 0
    while shared < len(prefix) and shared < len(words) - 1 and prefix[shared] == words[shared]:
        shared += 1
    words = words[shared:]
    if words[0][:1].isdigit():
        words.insert(0, prefix[-1])
    short = "_".join(words)
    return identifier(short)


def enum_name(official: str) -> str:
    """Return the name of an enum, which is in the namespace of its file."""
    return f"{official}_" if official in _TAKEN else identifier(official)


def _note(text: str) -> str:
    return f"  ///< {one_line(text)}" if text else ""


def _enum_aliases(library: Library, file: DialectFile, own: set[str]) -> Iterator[str]:
    """Yield aliases of the enums of included files; the file that is nearest to this one has all entries."""
    done = set(own)
    for item in reversed(closure(library, file)[:-1]):
        for enum, _ in enums(library, item):
            if enum.name not in done:
                done.add(enum.name)
                place = namespace(item.name)
                yield f"using {place}::{enum_name(enum.name)};\nusing {place}::{enum.name}_ENUM_END;\n"
