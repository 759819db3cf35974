"""The barrel, the registry of messages and enums, and the files of the npm package."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from mavstack.codegen.languages.typescript.names import property_names

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from mavstack.codegen.language import GeneratedFile
    from mavstack.codegen.languages.typescript.names import Names
    from mavstack.codegen.library import Library
    from mavstack.codegen.templates import Templates
    from mavstack.dialects.model import EnumDefinition, FieldDefinition, MessageDefinition


def package_files(
    templates: Templates,
    library: Library,
    names: Names,
    enums: Mapping[str, Sequence[EnumDefinition]],
    messages: Mapping[str, Sequence[MessageDefinition]],
) -> Iterator[GeneratedFile]:
    """Yield the files of the package that are not modules of messages or enums.

    Args:
        templates: The templates.
        library: The library.
        names: Its names.
        enums: The enums by module.
        messages: The messages by module.
    """
    values = {
        "library": library,
        "message_count": len(library.messages),
        "enum_count": len(library.enums),
        "package": library.package or f"mavlink-{library.name.replace('_', '-')}",
        "stamp": json.dumps(f"{library.stamp} SPDX-License-Identifier: MIT"),
        "exports": "\n".join(
            f'export * from "./{folder}/{module}.js";'
            for folder, modules in (("enums", enums), ("messages", messages))
            for module in modules
        ),
        **_registry(names, enums, messages),
        **_example(library, names),
    }
    for path in ("src/index.ts", "src/registry.ts", "package.json", "tsconfig.json", "README.md"):
        yield templates.file(path, f"{path.removeprefix('src/')}.j2", **values)


def _registry(
    names: Names,
    enums: Mapping[str, Sequence[EnumDefinition]],
    messages: Mapping[str, Sequence[MessageDefinition]],
) -> dict[str, str]:
    """Return the imports of the registry, its messages and its enums."""
    classes = (
        f"  messages{number}.{names.messages[item.name]},"
        for number, items in enumerate(messages.values(), 1)
        for item in items
    )
    rows = (
        f"  {enum.name}: enums{number}.{names.enums[enum.name]},"
        for number, items in enumerate(enums.values(), 1)
        for enum in items
    )
    imports = (
        f'import * as {folder}{number} from "./{folder}/{module}.js";'
        for folder, modules in (("enums", enums), ("messages", messages))
        for number, module in enumerate(modules, 1)
    )
    return {"imports": "\n".join(imports), "classes": "\n".join(classes), "enums": "\n".join(sorted(rows))}


def _example(library: Library, names: Names) -> dict[str, Any]:
    """Return the message of the example in the README, and values for it."""
    message = next((item for item in library.messages if item.name == "HEARTBEAT"), library.messages[0])
    properties = list(zip(property_names(message), message.fields, strict=True))
    needed = [item for item in properties if not (item[1].extension or item[1].protocol_version)]
    return {
        "example": names.messages[message.name],
        "example_name": message.name,
        "example_field": properties[0][0],
        "example_values": ", ".join(f"{name}: {_literal(field)}" for name, field in needed),
    }


def _literal(field: FieldDefinition) -> str:
    if field.type == "char":
        return '""'
    number = "0n" if field.type in ("int64_t", "uint64_t") else "0"
    return f"[{number}]" if field.array_length else number
