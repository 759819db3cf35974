"""Names in TypeScript: classes, properties and enum members.

Messages and enums are classes and objects in PascalCase, fields properties in camelCase. Property names may be
reserved words; the names of classes may be neither reserved words nor names that the modules use themselves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.codegen.templates import camel_case
from mavstack.dialects.names import class_name, member_names

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.codegen.library import Library
    from mavstack.dialects.model import EnumDefinition, MessageDefinition

#: Reserved words of ECMAScript in strict mode and of TypeScript.
RESERVED_WORDS: Final = frozenset(
    "any as async await bigint boolean break case catch class const constructor continue debugger default "
    "delete do else enum export extends false finally for from function get if implements import in instanceof "
    "interface let new null number object of package private protected public return set static string super "
    "switch symbol this throw true try type typeof undefined unknown var void while with yield".split()
)
#: Names that the generated modules use or export.
_USED: Final = frozenset(
    "ArrayLike BigInt DataView Init Math MessageFields Number Object Open Packet PacketBuilder Parser RawPacket "
    "Signing String Symbol Uint8Array Record Readonly MessageType MessageInfo FieldInfo FieldType InitOf PacketOf "
    "AnyMessageType MessageTable Counters ParserOptions SigningOptions Refusal PacketHeader".split()
)
#: Properties of every message class.
_METHODS: Final = frozenset({"constructor", "toObject", "toJSON"})


class Names:
    """The names of a library: no two exports have one name.

    Args:
        library: The library.
    """

    def __init__(self, library: Library) -> None:
        taken = set(_USED)
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
    return [_unique(camel_case(field.name), taken) for field in message.fields]


def _unique(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def file_names(names: Iterable[str]) -> dict[str, str]:
    """Return the module names of definition files: lower case with hyphens."""
    return {name: name.lower().replace("_", "-").replace(" ", "-") for name in names}
