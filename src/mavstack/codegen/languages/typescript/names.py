"""Names in TypeScript: classes, properties and enum members.

Messages and enums are classes and objects in PascalCase, fields properties in camelCase. Property names may
be reserved words; the names of classes may not be names that the modules use.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Final

from mavstack.codegen.templates import camel_case
from mavstack.dialects.names import class_name, member_names

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.codegen.library import Library
    from mavstack.dialects.model import EnumDefinition, MessageDefinition

#: Names that the generated modules use or export.
_USED: Final = """
    AnyMessageType ArrayLike BigInt Counters DataView FieldInfo FieldType Init InitOf Math
    MessageFields MessageInfo MessageTable MessageType Number Object Open Packet PacketBuilder
    PacketHeader PacketOf Parser ParserOptions RawPacket Readonly Record Refusal Signing
    SigningOptions String Symbol Uint8Array
"""
#: Properties of every message class.
_METHODS: Final = frozenset({"constructor", "toObject", "toJSON"})
#: Words that a property may not be named; those of ECMAScript and TypeScript are allowed.
RESERVED_WORDS: Final = _METHODS


class Names:
    """The names of a library: no two exports have one name.

    Args:
        library: The library.
    """

    def __init__(self, library: Library) -> None:
        self.version = library.version
        self.definitions = {item.name: item for item in library.enums}
        taken = set(_USED.split())
        self.messages = {item.name: _unique(class_name(item.name), taken) for item in library.messages}
        taken |= {f"{name}Fields" for name in self.messages.values()}
        self.enums = {item.name: _unique(class_name(item.name), taken) for item in library.enums}
        self._origins: dict[str, list[str]] = {}
        for file in library.files:
            for enum in file.enums:
                self._origins.setdefault(enum.name, [entry.name for entry in enum.entries])

    def members(self, enum: EnumDefinition) -> list[str]:
        """Return the member names of the entries of an enum."""
        names = [entry.name for entry in enum.entries]
        origin = [name for name in self._origins.get(enum.name, names) if name in set(names)]
        known = set(origin)
        members = member_names(enum.name, origin, [name for name in names if name not in known], ())
        return [members[name] for name in names]


def property_names(message: MessageDefinition) -> list[str]:
    """Return the property names of the fields of a message."""
    taken = set(_METHODS)
    return [_unique(_camel(field.name), taken) for field in message.fields]


_camel = cache(camel_case)


def _unique(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def file_names(names: Iterable[str]) -> dict[str, str]:
    """Return the module names of definition files: lower case with hyphens."""
    return {name: name.lower().replace("_", "-").replace(" ", "-") for name in names}
