"""The files of a TypeScript library.

A module for the messages and one for the enums of each definition file keep the number of modules small,
which a browser or Node loads one by one; bundlers leave out the classes that a program does not use.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, Final

from mavstack.codegen.language import Language
from mavstack.codegen.languages.typescript.fields import Property, is_wide, make_property
from mavstack.codegen.languages.typescript.names import RESERVED_WORDS, Names, file_names, property_names
from mavstack.codegen.languages.typescript.package import package_files
from mavstack.codegen.languages.typescript.runtime import runtime_files
from mavstack.codegen.templates import Templates, one_line

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen.language import GeneratedFile
    from mavstack.codegen.library import Library
    from mavstack.dialects.model import EnumDefinition, EnumEntry, MessageDefinition, Replacement


def render(library: Library) -> Iterator[GeneratedFile]:
    """Yield the files of a TypeScript library."""
    templates = _templates()
    names, modules = Names(library), file_names(file.name for file in library.files)
    yield from runtime_files(templates, library)
    enums, messages = _by_module(library, modules)
    wide = _wide_enums(library)
    for module, items in enums.items():
        lines = "\n".join(_enum(item, names, wide) for item in items)
        yield templates.file(f"src/enums/{module}.ts", "enums.ts.j2", library=library, enums=lines)
    homes = {item.name: module for module, items in enums.items() for item in items}
    for module, members in messages.items():
        yield templates.file(
            f"src/messages/{module}.ts",
            "messages.ts.j2",
            library=library,
            **_messages(templates, members, names, homes),
        )
    yield from package_files(templates, library, names, enums, messages)


@cache
def _templates() -> Templates:
    return Templates("mavstack.codegen.languages.typescript")


def _by_module(
    library: Library, modules: dict[str, str]
) -> tuple[dict[str, list[EnumDefinition]], dict[str, list[MessageDefinition]]]:
    """Return the enums by the module of the file that first defines each, and the messages by module."""
    merged = {enum.name: enum for enum in library.enums}
    enums: dict[str, list[EnumDefinition]] = {}
    messages: dict[str, list[MessageDefinition]] = {}
    for file in library.files:
        own = [merged.pop(enum.name) for enum in file.enums if enum.name in merged]
        if own:
            enums[modules[file.name]] = own
        if file.messages:
            messages[modules[file.name]] = list(file.messages)
    return enums, messages


def _wide_enums(library: Library) -> frozenset[str]:
    uses: dict[str, set[str]] = {}
    for message in library.messages:
        for field in message.fields:
            if field.enum:
                uses.setdefault(field.enum, set()).add(field.type)
    return frozenset(name for name, types in uses.items() if is_wide(types))


def _enum(enum: EnumDefinition, names: Names, wide: frozenset[str]) -> str:
    suffix = "n" if enum.name in wide else ""
    name = names.enums[enum.name]
    members = zip(names.members(enum), enum.entries, strict=True)
    if enum.bitmask or suffix:
        alias = "bigint" if suffix else "number"
    else:
        alias = f"(typeof {name})[keyof typeof {name}]"
    text = f"{enum.name}: {enum.description}" if enum.description else enum.name
    lines = [
        "",
        *_doc([text], enum.deprecated),
        f"export const {name} = {{",
        *(line for member, entry in members for line in _member(member, entry, suffix)),
        "} as const;",
        f"export type {name} = {alias};",
    ]
    return "\n".join(lines)


def _member(name: str, entry: EnumEntry, suffix: str) -> list[str]:
    texts = [entry.description] if entry.description else []
    for param in entry.params:
        text = " ".join(
            filter(None, (param.label, f"({param.units})" if param.units else "", param.description))
        )
        if text and not param.reserved:
            texts.append(f"Param {param.index}: {text}")
    doc = _doc(texts, entry.deprecated)
    return [*[f"  {line}" for line in doc], f"  {name}: {entry.value}{suffix},"]


def _doc(lines: list[str], deprecated: Replacement | None = None) -> list[str]:
    """Return the lines of a documentation comment; none without text."""
    if deprecated is not None:
        replaced = f" since {deprecated.since}" if deprecated.since else ""
        use = f", use {deprecated.replaced_by}" if deprecated.replaced_by else ""
        lines = [*lines, f"@deprecated{replaced}{use}"]
    if len(lines) > 1:
        return ["/**", *[f" * {one_line(line)}" for line in lines], " */"]
    return [f"/** {one_line(line)} */" for line in lines]


def _messages(
    templates: Templates, messages: list[MessageDefinition], names: Names, homes: dict[str, str]
) -> dict[str, str]:
    """Return the values of the template of a module with messages."""
    texts, imports, used = [], dict[str, set[str]](), {"Init", "MessageInfo"}
    for message in messages:
        properties = [
            make_property(
                field, name, names.enums.get(field.enum, ""), names.definitions.get(field.enum), names.version
            )
            for field, name in zip(message.fields, property_names(message), strict=True)
        ]
        for item in properties:
            alias = names.enums.get(item.field.enum, "")
            if alias and alias in item.type:
                imports.setdefault(homes[item.field.enum], set()).add(alias)
            if item.type.startswith("Open<"):
                used.add("Open")
        texts.append(
            templates.text("message.ts.j2", **_message(message, names.messages[message.name], properties))
        )
    return {
        "messages": "".join(texts),
        "imports": "".join(
            f'import type {{ {", ".join(sorted(items))} }} from "../enums/{module}.js";\n'
            for module, items in sorted(imports.items())
        ),
        "used": ", ".join(sorted(used)),
    }


def _message(message: MessageDefinition, name: str, properties: list[Property]) -> dict[str, Any]:
    optional = [item.name for item in properties if item.field.extension or item.field.protocol_version]
    options = " | ".join(f'"{item}"' for item in optional)
    text = f"{message.name} ({message.id})" + (f": {message.description}" if message.description else "")
    return {
        "name": name,
        "info": message,
        "doc": "\n".join(_doc([text], message.deprecated)),
        "lines": "\n".join([line for item in properties for line in _property(item)]),
        "fields": "\n".join([f"      {item.info}," for item in properties]),
        "writes": "\n".join([f"    {item.write}" for item in properties]),
        "getters": "\n".join(
            [f"\n  get {item.name}(): {item.type} {{\n    return {item.read};\n  }}" for item in properties]
        ),
        "init": f"Init<{name}Fields, {options}>" if options else f"Init<{name}Fields>",
        "object": ", ".join([f"{item.name}: this.{item.name}" for item in properties]),
    }


def _property(item: Property) -> list[str]:
    field = item.field
    notes = [field.description] if field.description else []
    if field.units:
        notes.append(f"Unit: {field.units}{f', times {field.multiplier}' if field.multiplier else ''}.")
    if field.array_length and field.enum:
        notes.append(f"Values of {field.enum}.")
    if field.extension:
        notes.append("Extension, MAVLink 2 only.")
    declared = f"  readonly {item.name}: {item.type};"
    return [f"  /** {one_line(' '.join(notes))} */", declared] if notes else [declared]


LANGUAGE: Final = Language("typescript", "TypeScript (ES modules)", render, RESERVED_WORDS)
