"""The dissector as one Lua file, and its README.

The messages are rows of data that the code at the head of the file registers, so that the file stays small
and the code is the same for each dialect.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Final

from mavstack.codegen.language import Language
from mavstack.codegen.templates import Templates, string_literal
from mavstack.dialects.names import shared_prefix

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen.language import GeneratedFile
    from mavstack.codegen.library import Library
    from mavstack.dialects.model import EnumDefinition, FieldDefinition, MessageDefinition

#: First words of the dissector's own filters; a message with such a name gets a trailing `_`.
_OWN_FILTERS: Final = frozenset(
    {"compat_flags", "compid", "crc", "incompat_flags", "junk", "len", "magic", "message", "msgid"}
    | {"newer_fields", "payload", "response_in", "response_time", "response_to", "seq", "signature"}
    | {"skipped", "sysid", "unknown", "version"}
)


def render(library: Library) -> Iterator[GeneratedFile]:
    """Yield the files of a dissector."""
    path = f"mavlink_{library.name}.lua" if not library.package else f"{library.package}.lua"
    values = {
        "library": library,
        "file": path,
        "enums": [_enum(item) for item in library.enums],
        "messages": [_message(item) for item in library.messages],
        "params": [line for item in library.enums if item.name == "MAV_CMD" for line in _params(item)],
    }
    yield _templates().file(path, "mavlink.lua.j2", **values)
    yield _templates().file("README.md", "README.md.j2", **values)


@cache
def _templates() -> Templates:
    return Templates("mavstack.codegen.languages.wireshark")


def _enum(enum: EnumDefinition) -> str:
    prefix = shared_prefix(enum.name, [entry.name for entry in enum.entries])
    rows = ", ".join(
        f'{{"{entry.name}", {entry.value}, "{entry.name.removeprefix(prefix).lower()}"}}'
        if enum.bitmask
        else f'{{"{entry.name}", {entry.value}}}'
        for entry in enum.entries
    )
    return f'enum("{enum.name}", {str(enum.bitmask).lower()}, {{{rows}}})'


def _message(message: MessageDefinition) -> str:
    name = message.name.lower()
    prefix = f"mavlink.{name}_" if name in _OWN_FILTERS else f"mavlink.{name}"
    rows = ",\n  ".join(_field(field) for field in message.fields)
    return (
        f'message({message.id}, "{message.name}", "{prefix}", {message.crc_extra}, {message.base_length}, '
        f"{message.length}, {string_literal(message.description)}, {{\n  {rows},\n}})"
    )


def _field(field: FieldDefinition) -> str:
    return (
        f'{{"{field.name}", "{field.type}", {field.array_length}, {field.offset}, '
        f"{str(field.extension).lower()}, {string_literal(field.units)}, {string_literal(field.enum)}, "
        f"{string_literal(field.description)}}}"
    )


def _params(commands: EnumDefinition) -> Iterator[str]:
    """Yield a row for each command with labels of its parameters."""
    for entry in commands.entries:
        labels = [
            f"[{param.index}] = {string_literal(param.label + (f', {param.units}' if param.units else ''))}"
            for param in entry.params
            if param.label
        ]
        if labels:
            yield f"[{entry.value}] = {{{', '.join(labels)}}},"


LANGUAGE: Final = Language("wireshark", "Wireshark dissector (Lua)", render)
