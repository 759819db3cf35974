"""Names in TypeScript: classes, properties and enum members.

Messages and enums are classes and objects in PascalCase, fields properties in camelCase. Property names may
be reserved words; the names of classes may not be names that the modules use.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Final

from mavstack.codegen.identifiers import distinct, enum_members, type_names
from mavstack.codegen.templates import camel_case
from mavstack.dialects.names import class_name

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
_METHODS: Final = frozenset({"constructor", "toJSON", "toObject", "toString", "valueOf"})
#: Names that a property must not have; reserved words of ECMAScript and TypeScript are allowed.
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
        self.messages = {item.name: _class(item.name, taken) for item in library.messages}
        self.enums = type_names((item.name for item in library.enums), taken)
        self._members = enum_members(library)

    def members(self, enum: EnumDefinition) -> list[str]:
        """Return the member names of the entries of an enum."""
        return [self._members[enum.name][entry.name] for entry in enum.entries]


def _class(official: str, taken: set[str]) -> str:
    """Return the name of a message's class, and take it and that of the interface of its fields."""
    name = class_name(official)
    while name in taken or f"{name}Fields" in taken:
        name += "_"
    taken |= {name, f"{name}Fields"}
    return name


def property_names(message: MessageDefinition) -> list[str]:
    """Return the property names of the fields of a message."""
    return distinct((_property(field.name) for field in message.fields), _METHODS)


@cache
def _property(name: str) -> str:
    camel = camel_case(name)
    return camel if camel[:1].isalpha() else f"_{camel}"


def file_names(names: Iterable[str]) -> dict[str, str]:
    """Return the module names of definition files: lower case with hyphens."""
    return {name: name.lower().replace("_", "-").replace(" ", "-") for name in names}
