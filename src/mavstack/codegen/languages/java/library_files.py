"""The files of a Java library: the runtime, a class for each message, an enum for each enum."""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING, Any, Final

from mavstack.codegen.identifiers import camel_field, distinct, enum_members, package_part, type_names
from mavstack.codegen.language import GeneratedFile, Language
from mavstack.codegen.languages.java.field_access import ARRAYS, SCALARS, Access, access, field_type
from mavstack.codegen.languages.java.reserved import JAVA_WORDS, OTHER_CLASSES, RUNTIME
from mavstack.codegen.message_facts import message_facts, table_row
from mavstack.codegen.templates import Templates, one_line, string_literal
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen.library import Library
    from mavstack.dialects.model import EnumDefinition, EnumEntry, FieldDefinition, MessageDefinition

#: Messages per method: the virtual machine only interprets a method of over 8,000 bytes, and 64 KiB is the
#: maximum.
_CASES: Final = 300
_PACKAGE: Final = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*")
_MAX_INT: Final = 0x7FFFFFFF


def render(library: Library) -> Iterator[GeneratedFile]:
    """Yield the files of a Java library.

    Raises:
        InvalidArgumentError: The package is not a name of Java.
    """
    package = library.package or _default_package(library.name)
    if not _PACKAGE.fullmatch(package) or JAVA_WORDS & set(package.split(".")):
        raise InvalidArgumentError(f"package must be a name such as org.example.mavlink, got {package!r}")
    templates = Templates(
        __package__, stamp=one_line(library.stamp), package=package, name=package_part(library.name)
    )
    folder = f"src/main/java/{package.replace('.', '/')}"
    classes = type_names((message.name for message in library.messages), {*OTHER_CLASSES, *RUNTIME})
    yield from _runtime(library, templates, folder, classes)
    enums = type_names((enum.name for enum in library.enums), OTHER_CLASSES)
    links = {name: f"{package}.enums.{java}" for name, java in enums.items()}
    for message in library.messages:
        values = _message(message, classes[message.name], links)
        yield templates.file(
            f"{folder}/messages/{classes[message.name]}.java",
            "message.java.j2",
            imports="".join(f"import {package}.{name};\n" for name in _imports(message)),
            **values,
        )
    members = enum_members(library)
    for enum in library.enums:
        values = _enum(enum, enums[enum.name], members[enum.name])
        methods = templates.text(_methods(enum, values), **values)
        path = f"{folder}/enums/{enums[enum.name]}.java"
        yield templates.file(path, "enum.java.j2", methods=methods, **values)


def _runtime(
    library: Library, templates: Templates, folder: str, classes: dict[str, str]
) -> Iterator[GeneratedFile]:
    cases = [(message.id, classes[message.name]) for message in library.messages]
    parts = [cases[start : start + _CASES] for start in range(0, len(cases), _CASES)]
    dialect = {
        "count": len(library.messages),
        "version": library.version,
        "max_length": library.max_payload_length,
        "table": "".join(f"        {table_row(message)}\n" for message in library.messages),
        "dispatch": "".join(_dispatch(part, index, len(parts)) for index, part in enumerate(parts, 1)),
        "creators": "".join(_creator(part, index) for index, part in enumerate(parts, 1)),
        "scalars": "".join(
            templates.text("wire_scalar.java.j2", name=name, java=java, read=read, write=write)
            for name, java, read, write in SCALARS
        ),
        "arrays": "".join(
            templates.text("wire_array.java.j2", name=name, java=java, element=element, size=size)
            for name, java, element, size in ARRAYS
        ),
        "example": templates.text("example.md.j2") if classes.get("HEARTBEAT") == "Heartbeat" else "",
    }
    for name in RUNTIME:
        yield templates.file(f"{folder}/{name}.java", f"{name}.java.j2", **dialect)
    yield templates.file("pom.xml", "pom.xml.j2")
    yield templates.file("README.md", "README.md.j2", **dialect)


def _dispatch(part: list[tuple[int, str]], index: int, count: int) -> str:
    if index == count:
        return f"        return create{index}(id);\n"
    return f"        if (id <= {part[-1][0]}) {{\n            return create{index}(id);\n        }}\n"


def _creator(part: list[tuple[int, str]], index: int) -> str:
    cases = "".join(
        f"            case {number}:\n                return new {name}();\n" for number, name in part
    )
    rest = "            default:\n                return null;\n        }\n    }\n"
    return f"\n    private static Message create{index}(int id) {{\n        switch (id) {{\n{cases}{rest}"


def _default_package(name: str) -> str:
    part = package_part(name)
    return f"mavlink.{part}_" if part in JAVA_WORDS else f"mavlink.{part}"


def _imports(message: MessageDefinition) -> list[str]:
    names = ["FieldInfo", "FieldType", "Message", "MessageInfo", "Wire"]
    used = names if message.fields else ["Message", "MessageInfo"]
    return ["Dialect", *used] if any(field.protocol_version for field in message.fields) else used


def _message(message: MessageDefinition, class_name: str, links: dict[str, str]) -> dict[str, Any]:
    names = distinct((camel_field(field.name) for field in message.fields), JAVA_WORDS)
    fields = {
        field.name: (name, _commented(field, links), access(field, name))
        for field, name in zip(message.fields, names, strict=True)
    }
    wire = [fields[field.name][2] for field in message.wire_order]
    return {
        **message_facts(message),
        "class_name": class_name,
        "title": comment(f"{message.name} ({message.id}): {message.description}".rstrip(": ")),
        "deprecation": _deprecation(message),
        "infos": "".join(_info(message)),
        "fields": "".join(_declaration(*item) for item in fields.values()),
        "values": "".join(
            f"            case {index}:\n                return this.{name};\n"
            for index, name in enumerate(names)
        ),
        "decode": "".join(f"        {field.decode}\n" for field in wire),
        "encode": "".join(f"        {field.encode}\n" for field in wire),
    }


def _commented(field: FieldDefinition, links: dict[str, str]) -> str:
    units = f" [{field.units}]" if field.units else ""
    enum = f" Values: {{@link {links[field.enum]}}}." if field.enum in links else ""
    return comment(f"{field.description or field.name}{units}") + enum


def _declaration(name: str, text: str, field: Access) -> str:
    return f"    /** {text} */\n    public {field.java} {name}{field.initial};\n\n"


def _deprecation(item: MessageDefinition) -> str:
    """Return the end of the comment, and the annotation."""
    if item.deprecated is None:
        return " */\n"
    replaced = f", replaced by {item.deprecated.replaced_by}" if item.deprecated.replaced_by else ""
    return f" *\n * @deprecated since {comment(item.deprecated.since + replaced)}\n */\n@Deprecated\n"


def _info(message: MessageDefinition) -> Iterator[str]:
    for field in message.fields:
        texts = f'{string_literal(field.units)}, "{field.enum}"'
        extension = "true" if field.extension else "false"
        place = f"{field.offset}, {field.array_length}, {extension}"
        yield f',\n            new FieldInfo("{field.name}", FieldType.{field_type(field)}, {place}, {texts})'


def _enum(enum: EnumDefinition, class_name: str, members: dict[str, str]) -> dict[str, Any]:
    words = {*JAVA_WORDS, "value"}
    names = dict(zip(members, distinct(members.values(), words), strict=True))
    wide = any(not -_MAX_INT <= entry.value <= _MAX_INT for entry in enum.entries)
    suffix = "L" if wide else ""
    values = {entry.name: f"{_signed(entry.value)}{suffix}" for entry in enum.entries}
    entries = [
        f"    /** {_described(entry)} */\n    {names[entry.name]}({values[entry.name]})"
        for entry in enum.entries
    ]
    distinct_values = {value: names[name] for name, value in reversed(values.items())}
    return {
        "class_name": class_name,
        "title": comment(f"{enum.name}: {enum.description}".rstrip(": ")),
        "type": "long" if wide else "int",
        "imports": "import java.util.EnumSet;\n\n" if enum.bitmask else "",
        "entries": ",\n".join(entries) + (";\n" if entries else "    ;\n"),
        "cases": "".join(
            f"            case {value}:\n                return {name};\n"
            for value, name in reversed(distinct_values.items())
        ),
    }


def _methods(enum: EnumDefinition, values: dict[str, Any]) -> str:
    """Return the template of the methods of an enum; Java has no switch over `long`."""
    if enum.bitmask:
        return "flag_methods.java.j2"
    return "switch_method.java.j2" if values["type"] == "int" else "search_method.java.j2"


def _described(entry: EnumEntry) -> str:
    return comment(f"{entry.name} ({entry.value}): {entry.description}".rstrip(": "))


def _signed(value: int) -> int:
    """Return the 64-bit value as Java writes it."""
    return value - (1 << 64) if value >= 1 << 63 else value


def comment(text: str) -> str:
    """Return a text for a comment of documentation, without its special characters."""
    escaped = escape(one_line(text), quote=False).replace("@", "&#64;")
    return escaped.replace("\\", "&#92;").replace("{", "&#123;")


LANGUAGE: Final = Language("java", "Java 11", render, JAVA_WORDS)
