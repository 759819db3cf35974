"""The files of a Go library: one package, a file for each message and enum, and the runtime."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

from mavstack.codegen.identifiers import distinct, enum_members, package_part, pascal_field, type_names
from mavstack.codegen.language import GeneratedFile, Language
from mavstack.codegen.languages.go.field_access import access, field_type, imports
from mavstack.codegen.languages.go.reserved import GO_WORDS, METHODS, RUNTIME, RUNTIME_NAMES
from mavstack.codegen.message_facts import enum_numbers, message_facts
from mavstack.codegen.templates import Templates, one_line, string_literal
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen.library import Library
    from mavstack.codegen.message_facts import EnumNumber
    from mavstack.dialects.model import EnumDefinition, EnumEntry, FieldDefinition, MessageDefinition

_MODULE: Final = re.compile(r"[a-z0-9][\w.~-]*(/[\w.~-]+)*", re.ASCII | re.IGNORECASE)


def render(library: Library) -> Iterator[GeneratedFile]:
    """Yield the files of a Go library.

    Raises:
        InvalidArgumentError: The package is not the path of a module.
    """
    module = library.package or f"example.com/mavlink/{package_part(library.name)}"
    if not _MODULE.fullmatch(module):
        raise InvalidArgumentError(f"package must be a module such as example.org/mavlink, got {module!r}")
    templates = Templates(
        __package__,
        stamp=one_line(library.stamp),
        package=_package(module),
        module=module,
        name=package_part(library.name),
    )
    official = [message.name for message in library.messages]
    classes = type_names(official, RUNTIME_NAMES)
    enums = type_names((enum.name for enum in library.enums), {*RUNTIME_NAMES, *classes.values()})
    yield from _runtime(library, templates, classes)
    for message in library.messages:
        values = _message(message, classes[message.name], enums)
        yield templates.file(f"{message.name.lower()}_message.go", "struct.go.j2", **values)
    members = enum_members(library)
    taken = {*RUNTIME_NAMES, *classes.values(), *enums.values()}
    numbers = enum_numbers(library)
    for enum in library.enums:
        values = _enum(enum, enums[enum.name], members[enum.name], taken, numbers[enum.name])
        yield templates.file(f"{enum.name.lower()}_enum.go", "enum.go.j2", **values)


def _package(module: str) -> str:
    """Return the name of the package: the last part of the path, without a version such as `v2`."""
    parts = [part for part in module.split("/") if not re.fullmatch(r"v\d+", part)] or ["mavlink"]
    name = package_part(parts[-1]).replace("_", "")
    return f"{name}mav" if name in GO_WORDS or name in ("main", "internal") else name


def _runtime(library: Library, templates: Templates, classes: dict[str, str]) -> Iterator[GeneratedFile]:
    values = {
        "count": len(library.messages),
        "version": library.version,
        "max_length": library.max_payload_length,
        "infos": "".join(f"\t&info{name},\n" for name in classes.values()),
        "slots": 1 << (2 * len(library.messages)).bit_length(),
        "example": templates.text("example.md.j2") if "HEARTBEAT" in classes else "",
    }
    for name in RUNTIME:
        yield templates.file(f"{name}.go", f"{name}.go.j2", **values)
    yield templates.file("go.mod", "go.mod.j2")
    yield templates.file("README.md", "README.md.j2", **values)


def _message(message: MessageDefinition, class_name: str, enums: dict[str, str]) -> dict[str, Any]:
    names = distinct((_exported(field.name) for field in message.fields), METHODS)
    done = {
        field.name: access(field, name, enums.get(field.enum))
        for field, name in zip(message.fields, names, strict=True)
    }
    named = list(zip(message.fields, names, strict=True))
    wire = [done[field.name] for field in message.wire_order]
    return {
        **message_facts(message),
        "class_name": class_name,
        "title": comment(f"{message.name} ({message.id}): {message.description}".rstrip(": ")),
        "tags": _deprecation(message),
        "bound": f"\t_ = b[{message.length - 1}]\n" if message.length > 1 else "",
        "imports": _imports(message),
        "fields": "".join(
            f"\t// {_commented(field)}\n\t{name} {done[field.name].go}\n" for field, name in named
        ),
        "infos": "".join(map(_info, message.fields)),
        "values": "".join(f"\tcase {index}:\n\t\treturn m.{name}\n" for index, name in enumerate(names)),
        "decode": "".join(f"\t{line}\n" for field in wire for line in field.decode),
        "encode": "".join(f"\t{line}\n" for field in wire for line in field.encode),
    }


def _exported(name: str) -> str:
    """Return a name that begins with an upper-case letter, as exported names do."""
    pascal = pascal_field(name).lstrip("_")
    return pascal if pascal[:1].isalpha() else f"X{pascal}"


def _imports(message: MessageDefinition) -> str:
    names = [f'"{name}"' for name in imports(message.fields)]
    if len(names) < 2:
        return "".join(f"import {name}\n\n" for name in names)
    lines = "".join(f"\t{name}\n" for name in names)
    return f"import (\n{lines})\n\n"


def _commented(field: FieldDefinition) -> str:
    units = f" [{field.units}]" if field.units else ""
    return comment(f"{field.description or field.name}{units}")


def _info(field: FieldDefinition) -> str:
    place = f"{field.offset}, {field.array_length}, {'true' if field.extension else 'false'}"
    texts = f'{string_literal(field.units)}, "{field.enum}"'
    return f'\t\t{{"{field.name}", {field_type(field)}, {place}, {texts}}},\n'


def _deprecation(message: MessageDefinition) -> str:
    if message.deprecated is None:
        return ""
    replaced = message.deprecated.replaced_by
    replacement = f", replaced by {comment(replaced)}" if replaced else ""
    return f"//\n// Deprecated: since {comment(message.deprecated.since)}{replacement}.\n"


def _enum(
    enum: EnumDefinition, class_name: str, members: dict[str, str], taken: set[str], number: EnumNumber
) -> dict[str, Any]:
    constants = (f"{class_name}{pascal_field(name).lstrip('_')}" for name in members.values())
    names = dict(zip(members, distinct(constants, taken), strict=True))
    taken.update(names.values())
    entries = [
        f"\t// {_described(entry)}\n\t{names[entry.name]} {class_name} = {entry.value}\n"
        for entry in enum.entries
    ]
    values = f"// Values of {class_name}.\nconst (\n{''.join(entries)})\n\n" if entries else ""
    return {
        "class_name": class_name,
        "title": comment(f"{enum.name}: {enum.description}".rstrip(": ")),
        "type": f"{'' if number.signed else 'u'}int{max(number.bits, 32)}",
        "constants": values,
        "each": ", or of each flag that is set" if enum.bitmask else "",
        "string": _flags_string(enum) if enum.bitmask else _value_string(enum, names),
    }


def _flags_string(enum: EnumDefinition) -> str:
    names = ", ".join(f'"{entry.name}"' for entry in enum.entries)
    values = ", ".join(str(entry.value % (1 << 64)) for entry in enum.entries)
    lists = f"\t\t[]string{{{names}}},\n\t\t[]uint64{{{values}}})\n"
    return f'\treturn flagsText("{enum.name}", uint64(v),\n{lists}'


def _value_string(enum: EnumDefinition, names: dict[str, str]) -> str:
    otherwise = f'\treturn enumText("{enum.name}", uint64(v))\n'
    first = {entry.value: entry.name for entry in reversed(enum.entries)}
    cases = (f'\tcase {names[name]}:\n\t\treturn "{name}"\n' for name in reversed(first.values()))
    return f"\tswitch v {{\n{''.join(cases)}\t}}\n{otherwise}" if first else otherwise


def _described(entry: EnumEntry) -> str:
    return comment(f"{entry.name} ({entry.value}): {entry.description}".rstrip(": "))


def comment(text: str) -> str:
    """Return a text for a comment; gofmt makes one mark of two quotation marks."""
    return one_line(text).replace("''", '"').replace("``", '"')


LANGUAGE: Final = Language("go", "Go 1.21", render)
