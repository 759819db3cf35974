"""The files of a Lua module: a runtime, and one small file for each message, loaded on first use."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Final

from mavstack.codegen.identifiers import enum_members
from mavstack.codegen.message_facts import message_facts
from mavstack.codegen.templates import Templates, one_line, string_literal
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.codegen.language import GeneratedFile
    from mavstack.codegen.library import Library
    from mavstack.dialects.model import EnumDefinition, EnumEntry, FieldDefinition, MessageDefinition

_WORDS: Final = """
and break do else elseif end false for function goto if in local nil not or repeat return then true
until while
"""
RESERVED_WORDS: Final = frozenset(_WORDS.split())

_RUNTIME: Final = (
    "definitions", "encoder", "enums", "lua53", "luajit", "native", "packet", "parser", "scan", "signing"
)  # fmt: skip


def render(library: Library) -> Iterator[GeneratedFile]:
    """Yield the files of a module.

    Args:
        library: The library.

    Yields:
        The files.

    Raises:
        InvalidArgumentError: The chosen name is not that of a Lua module.
    """
    files = sorted(_module_files(library), key=lambda file: file.path)
    yield from files
    templates = _templates()
    module = module_name(library)
    rock = f"{module}-{re.sub('[^a-z0-9]+', '-', library.name).strip('-')}"
    values = {"stamp": library.stamp, "dialect": library.name, "module": module, "rock": rock}
    modules = _lines(8, (_rock_line(file.path) for file in files))
    yield templates.file(f"{rock}-scm-1.rockspec", "rockspec.j2", modules=modules, **values)
    names = [message.name for message in library.messages]
    example = "HEARTBEAT" if "HEARTBEAT" in names else names[0]
    yield templates.file("README.md", "README.md.j2", example=example, **values)


def module_name(library: Library) -> str:
    """Return the name of the module: the chosen one, or `mavlink`."""
    name = library.package or "mavlink"
    if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
        raise InvalidArgumentError(f"package must be a name such as mavlink, got {name!r}")
    return name


def _module_files(library: Library) -> Iterator[GeneratedFile]:
    templates, module = _templates(), module_name(library)
    stamp = library.stamp
    values = {"stamp": stamp, "module": module, "dialect": library.name, "version": library.version}
    names = enum_members(library)
    rows = _lines(4, map(_index_line, library.messages))
    yield templates.file(f"{module}.lua", "mavlink.lua.j2", **values)
    yield templates.file(f"{module}/index.lua", "index.lua.j2", rows=rows, **values)
    enums = "\n".join(_enum_function(enum, names[enum.name]) for enum in library.enums)
    yield templates.file(f"{module}/enum_tables.lua", "enum_tables.lua.j2", enums=enums, **values)
    for name in _RUNTIME:
        yield templates.file(f"{module}/{name}.lua", f"{name}.lua.j2", **values)
    for message in library.messages:
        path = f"{module}/messages/{message.name.lower()}.lua"
        yield templates.file(path, "message.lua.j2", stamp=stamp, **_message_values(message))


@cache
def _templates() -> Templates:
    return Templates("mavstack.codegen.languages.lua")


def identifier(name: str) -> str:
    """Return the key of a field."""
    return f"{name}_" if name in RESERVED_WORDS else name


def _lines(indent: int, lines: Iterable[str]) -> str:
    """Return the lines of a table, indented."""
    return "\n".join(f"{' ' * indent}{line}" for line in lines)


def _doc(description: str) -> str:
    text = one_line(description)
    return f"--- {text}\n\n" if text else ""


def _rock_line(path: str) -> str:
    return f'["{path.removesuffix(".lua").replace("/", ".")}"] = "{path}",'


def _index_line(message: MessageDefinition) -> str:
    facts = f"{message.crc_extra}, {message.base_length}"
    return f'[{message.id}] = {{ "{message.name}", {facts}, "{message.name.lower()}" }},'


def _message_values(message: MessageDefinition) -> dict[str, object]:
    return {
        **message_facts(message),
        "doc": _doc(message.description),
        "fields": _lines(8, map(_field_line, message.fields)),
    }


def _field_line(item: FieldDefinition) -> str:
    """Return the table of a field."""
    names = f'name = "{item.name}", key = "{identifier(item.name)}", type = "{item.type}"'
    units = f", units = {string_literal(item.units)}" if item.units else ""
    enum = f', enum = "{item.enum}"' if item.enum else ""
    extension = ", extension = true" if item.extension else ""
    comment = f" -- {one_line(item.description)}" if item.description else ""
    place = f"offset = {item.offset}, array_length = {item.array_length}"
    return f"{{ {names}, {place}{units}{enum}{extension} }},{comment}"


def _enum_function(enum: EnumDefinition, names: dict[str, str]) -> str:
    """Return the function that returns the table of an enum."""
    entries = _lines(12, (_entry_line(entry, names[entry.name]) for entry in enum.entries))
    description = one_line(enum.description)
    return "\n".join(
        [
            *([f"    -- {description}"] if description else []),
            f'    ["{enum.name}"] = function()',
            f"        return {{ bitmask = {'true' if enum.bitmask else 'false'}, entries = {{",
            entries,
            "        } }",
            "    end,",
        ]
    )


def _entry_line(entry: EnumEntry, name: str) -> str:
    # Lua reads a decimal number over 2^63 as a float.
    value = hex(entry.value) if entry.value >= 1 << 63 else entry.value
    description = one_line(entry.description)
    return f'{{ "{name}", {value} }}, -- {entry.name}{f": {description}" if description else ""}'
