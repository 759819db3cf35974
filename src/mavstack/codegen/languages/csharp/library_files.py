"""The files of a C# library: the runtime, a class for each message, an enum for each enum."""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING, Any, Final

from mavstack.codegen.identifiers import distinct, enum_members, package_part, pascal_field, type_names
from mavstack.codegen.language import GeneratedFile, Language
from mavstack.codegen.languages.csharp.field_access import ARRAYS, TYPES, Access, access
from mavstack.codegen.languages.csharp.reserved import CLASSES, CSHARP_WORDS, MEMBERS, RUNTIME
from mavstack.codegen.message_facts import enum_numbers, message_facts, table_row
from mavstack.codegen.templates import Templates, one_line, string_literal
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen.library import Library
    from mavstack.codegen.message_facts import EnumNumber
    from mavstack.dialects.model import EnumDefinition, EnumEntry, FieldDefinition, MessageDefinition

_NAMESPACE: Final = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", re.ASCII)


def render(library: Library) -> Iterator[GeneratedFile]:
    """Yield the files of a C# library.

    Raises:
        InvalidArgumentError: The package is not a namespace.
    """
    namespace = library.package or f"Mavlink.{pascal_field(package_part(library.name))}"
    if not _NAMESPACE.fullmatch(namespace) or CSHARP_WORDS & set(namespace.split(".")):
        raise InvalidArgumentError(f"package must be a namespace such as Example.Mavlink, got {namespace!r}")
    templates = Templates(
        __package__, stamp=one_line(library.stamp), package=namespace, name=package_part(library.name)
    )
    classes = type_names(
        (message.name for message in library.messages), {*CLASSES, *MEMBERS, *namespace.split(".")}
    )
    taken = {*CLASSES, *classes.values(), *namespace.split(".")}
    enums = type_names((enum.name for enum in library.enums), taken)
    yield from _runtime(library, templates, namespace, classes)
    for message in library.messages:
        values = _message(message, classes[message.name], enums)
        yield templates.file(f"Messages/{classes[message.name]}.cs", "class.cs.j2", **values)
    members, numbers = enum_members(library), enum_numbers(library)
    for enum in library.enums:
        values = _enum(enum, enums[enum.name], members[enum.name], numbers[enum.name])
        yield templates.file(f"Enums/{enums[enum.name]}.cs", "enum.cs.j2", **values)


def _runtime(
    library: Library, templates: Templates, namespace: str, classes: dict[str, str]
) -> Iterator[GeneratedFile]:
    values = {
        "count": len(library.messages),
        "version": library.version,
        "max_length": library.max_payload_length,
        "table": "".join(f"            {table_row(message)}\n" for message in library.messages),
        "slots": 1 << (2 * len(library.messages)).bit_length(),
        "cases": "".join(
            f"                case {message.id}:\n                    return new {classes[message.name]}();\n"
            for message in library.messages
        ),
        "arrays": "".join(
            templates.text("wire_array.cs.j2", name=name, type=element, size=size)
            for name, element, size in ARRAYS
        ),
        "example": templates.text("example.md.j2") if classes.get("HEARTBEAT") == "Heartbeat" else "",
    }
    for name in RUNTIME:
        yield templates.file(f"{name}.cs", f"{name}.cs.j2", **values)
    yield templates.file(f"{namespace}.csproj", "project.csproj.j2")
    yield templates.file("README.md", "README.md.j2", **values)


def _message(message: MessageDefinition, class_name: str, enums: dict[str, str]) -> dict[str, Any]:
    names = _property_names(message, class_name, enums)
    fields = {
        field.name: (name, _commented(field), access(field, name, enums.get(field.enum)))
        for field, name in zip(message.fields, names, strict=True)
    }
    wire = [fields[field.name][2] for field in message.wire_order]
    return {
        **message_facts(message),
        "class_name": class_name,
        "title": comment(f"{message.name} ({message.id}): {message.description}".rstrip(": ")),
        "obsolete": _obsolete(message),
        "infos": "".join(_info(message)),
        "properties": "".join(_property(*item) for item in fields.values()),
        "values": "".join(
            f"                case {index}:\n                    return {name};\n"
            for index, name in enumerate(names)
        ),
        "decode": "".join(f"            {field.decode}\n" for field in wire),
        "encode": "".join(f"            {field.encode}\n" for field in wire),
    }


def _property_names(message: MessageDefinition, class_name: str, enums: dict[str, str]) -> list[str]:
    """Return the names of the properties: none hides a class that the code of the message names.

    The exception is a property with the name of its own type.
    """
    used = {enums[field.enum] for field in message.fields if field.enum in enums}
    names: list[str] = []
    for field in message.fields:
        own = enums.get(field.enum) if field.is_integer and not field.array_length else None
        name = pascal_field(field.name)
        while name in MEMBERS or name == class_name or name in names or (name in used and name != own):
            name += "_"
        names.append(name)
    return names


def _commented(field: FieldDefinition) -> str:
    units = f" [{field.units}]" if field.units else ""
    return comment(f"{field.description or field.name}{units}")


def _property(name: str, text: str, field: Access) -> str:
    return (
        f"        /// <summary>{text}</summary>\n"
        f"        public {field.type} {name} {{ get; set; }}{field.initial}\n\n"
    )


def _obsolete(message: MessageDefinition) -> str:
    if message.deprecated is None:
        return ""
    replaced = message.deprecated.replaced_by
    text = string_literal(
        f"since {message.deprecated.since}{f', replaced by {replaced}' if replaced else ''}"
    )
    return f"    [Obsolete({text})]\n"


def _info(message: MessageDefinition) -> Iterator[str]:
    for field in message.fields:
        texts = f'{string_literal(field.units)}, "{field.enum}"'
        place = f"{field.offset}, {field.array_length}, {'true' if field.extension else 'false'}"
        kind = f"FieldType.{TYPES[field.type][1]}"
        yield f',\n            new FieldInfo("{field.name}", {kind}, {place}, {texts})'


def _enum(
    enum: EnumDefinition, class_name: str, members: dict[str, str], number: EnumNumber
) -> dict[str, Any]:
    names = dict(zip(members, distinct(map(pascal_field, members.values())), strict=True))
    return {
        "class_name": class_name,
        "title": comment(f"{enum.name}: {enum.description}".rstrip(": ")),
        "type": f"{'' if number.signed else 'u'}{'long' if number.bits == 64 else 'int'}",
        "using": "using System;\n\n" if enum.bitmask else "",
        "flags": "    [Flags]\n" if enum.bitmask else "",
        "entries": "\n".join(_entry(entry, names[entry.name]) for entry in enum.entries),
    }


def _entry(entry: EnumEntry, name: str) -> str:
    text = comment(f"{entry.name} ({entry.value}): {entry.description}".rstrip(": "))
    return f"        /// <summary>{text}</summary>\n        {name} = {entry.value},\n"


def comment(text: str) -> str:
    """Return a text for a documentation comment, which is XML."""
    return escape(one_line(text), quote=False)


LANGUAGE: Final = Language("csharp", "C# (.NET Standard 2.0)", render)
