"""The metadata of events (component metadata of type EVENTS, libevents schema versions 1 and 2).

    table = parse_event_metadata(file)
    content = decode_content(table[event.id], event.arguments)
    content.name, content.message                   # "px4::commander_armed_by", "Armed by external command"

A message may contain placeholders `{1}`, `{2m}`, `{2:.1m}` (argument, decimals, unit), tags (`<param>`,
`<a>`, `<profile>`; others are left out with their content), and backslashes before characters that are meant
literally. Version 1 keeps entries in arrays, version 2 in objects by number or name. Invalid entries are left
out.
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from mavstack.errors import MetadataError
from mavstack.services.component_metadata import parse_json, unpack_content

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

Value: TypeAlias = "int | float | str"

#: Codes of `struct` by type name.
_CODES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "uint8_t": "B",
        "int8_t": "b",
        "uint16_t": "H",
        "int16_t": "h",
        "uint32_t": "I",
        "int32_t": "i",
        "uint64_t": "Q",
        "int64_t": "q",
        "float": "f",
    }
)
_MAX_COMPONENT: Final = 0xFF
_MAX_SUB_ID: Final = 0xFFFFFF
_UNITS: Final = {"m_v": "m", "C": "°C"}
_PART = re.compile(
    r"\\(?P<escaped>.)"
    r"|<profile name=\"(?P<not>!?)(?P<profile>[^\"]*)\">(?P<content>.*?)</profile>"
    r"|</?(?:a|param)(?: [^>]*)?>"
    r"|<(?P<tag>[a-z]+)(?: [^>]*)?>.*?</(?P=tag)>"
    r"|\{(?P<index>\d+)(?::(?:\.(?P<decimals>\d+))?)?(?P<unit>m_v|m/s|m\^2|m|C)?\}",
    re.DOTALL,
)
#: The largest number of characters of a text; the rest is cut off.
_MAX_TEXT: Final = 4000
#: The profile whose texts are shown: texts for users who are not developers.
_PROFILE: Final = "normal"


@dataclass(frozen=True, slots=True)
class EventEnum:
    """The named values of an argument.

    Attributes:
        name: The name of the enum.
        type: The type on the wire: "uint8_t".
        entries: Name and description of each value.
        is_bitfield: True if a value is a combination of entries.
        separator: The text between the descriptions of a combination.
    """

    name: str
    type: str
    entries: Mapping[int, tuple[str, str]]
    is_bitfield: bool = False
    separator: str = "|"

    def name_of(self, value: int) -> str:
        """Return the name of a value; of a bitfield, names joined by "|"; the number if it has none."""
        return self._joined(value, 0, "|")

    def text_of(self, value: int) -> str:
        """Return the description of a value; the name or the number if it has none."""
        return self._joined(value, 1, self.separator)

    def _joined(self, value: int, part: int, separator: str) -> str:
        if not self.is_bitfield:
            entry = self.entries.get(value)
            return str(value) if entry is None else entry[part] or entry[0]
        found = [entry[part] or entry[0] for bit, entry in self.entries.items() if value & bit]
        unnamed = value & ~sum(self.entries)
        return separator.join([*found, *([str(unnamed)] if unnamed or not found else [])])


@dataclass(frozen=True, slots=True)
class EventArgument:
    """An argument of an event: its name, its type on the wire, and the enum of its values or None."""

    name: str
    type: str
    enum: EventEnum | None = None


@dataclass(frozen=True, slots=True)
class EventDefinition:
    """The definition of an event.

    Attributes:
        id: The id: the component id of the namespace in the highest byte, and 24 bits.
        name: Namespace and name: "px4::commander_armed_by".
        message: The message, with placeholders.
        description: A longer text, with placeholders; may be empty.
        group: The group: "default", "calibration", "health", "arming_check".
        arguments: The arguments in the order of the wire.
    """

    id: int
    name: str
    message: str
    description: str = ""
    group: str = "default"
    arguments: tuple[EventArgument, ...] = ()


@dataclass(frozen=True, slots=True)
class EventContent:
    """The words of one event: those of its definition with its arguments.

    Attributes:
        name: Namespace and name: "px4::commander_armed_by".
        message: The message with its arguments.
        description: The longer text with its arguments; may be empty.
        arguments: The arguments by name; an enum's value as its name.
    """

    name: str
    message: str
    description: str = ""
    arguments: Mapping[str, Value] = field(default_factory=dict)


def parse_event_metadata(data: bytes) -> dict[int, EventDefinition]:
    """Parse a metadata file of events.

    Args:
        data: The file, compressed or not.

    Returns:
        The definitions, by id.

    Raises:
        MetadataError: The file is too large or damaged, or it is no metadata of events.
    """
    document = parse_json(unpack_content(data))
    if not isinstance(document.get("components"), dict | list):
        raise MetadataError("no metadata of events: 'components' is missing")
    found: dict[int, EventDefinition] = {}
    enums: dict[str, EventEnum] = {}
    components = list(_entries(document["components"], "component_id"))
    for _, component in components:
        enums.update(_enums_of(component))
    for key, component in components:
        number = _whole(key, _MAX_COMPONENT)
        if number is not None:
            found.update((each.id, each) for each in _events_of(number, component, enums))
    return found


def decode_content(definition: EventDefinition, arguments: bytes) -> EventContent:
    """Decode the arguments of an event, and put them into its texts.

    Args:
        definition: The definition of its id.
        arguments: The arguments as on the wire; missing bytes are zeros.

    Returns:
        The words of the event.
    """
    layout = struct.Struct("<" + "".join(_CODES[argument.type] for argument in definition.arguments))
    numbers = layout.unpack(arguments[: layout.size].ljust(layout.size, b"\0"))
    values: dict[str, Value] = {}
    for argument, number in zip(definition.arguments, numbers, strict=True):
        values[argument.name] = number if argument.enum is None else argument.enum.name_of(number)

    def text(template: str) -> str:
        return _formatted(template, definition.arguments, numbers).strip()

    return EventContent(definition.name, text(definition.message), text(definition.description), values)


def _formatted(template: str, arguments: tuple[EventArgument, ...], numbers: tuple[Any, ...]) -> str:
    def replaced(part: re.Match[str]) -> str:
        if part["escaped"]:
            return part["escaped"]
        if part["profile"] is not None:
            shown = (part["profile"] == _PROFILE) != bool(part["not"])
            return _formatted(part["content"], arguments, numbers) if shown else ""
        if part["index"] is None:  # a tag
            return ""
        index = int(part["index"]) - 1 if len(part["index"]) < 3 else -1
        if not 0 <= index < len(numbers):
            return part[0]
        unit = part["unit"] or ""
        value = _value_text(arguments[index], numbers[index], part["decimals"])
        return f"{value} {_UNITS.get(unit, unit)}".rstrip()

    return _PART.sub(replaced, template)


def _value_text(argument: EventArgument, number: float, decimals: str | None) -> str:
    if argument.enum is not None:
        return argument.enum.text_of(int(number))
    if decimals is not None:
        return f"{number:.{min(int(decimals[:2]), 9)}f}"
    return f"{number:g}" if isinstance(number, float) else str(number)


def _events_of(
    component: int, content: dict[str, Any], enums: Mapping[str, EventEnum]
) -> Iterator[EventDefinition]:
    namespace = _text(content, "namespace") or str(component)
    for group, group_content in _entries(content.get("event_groups"), "name"):
        for key, entry in _entries(group_content.get("events"), "sub_id"):
            sub_id, name = _whole(key, _MAX_SUB_ID), _text(entry, "name")
            arguments = _arguments_of(entry, enums, namespace)
            if sub_id is not None and name and arguments is not None:
                yield EventDefinition(
                    id=component << 24 | sub_id,
                    name=f"{namespace}::{name}",
                    message=_text(entry, "message"),
                    description=_text(entry, "description"),
                    group=str(group),
                    arguments=arguments,
                )


def _arguments_of(
    entry: dict[str, Any], enums: Mapping[str, EventEnum], namespace: str
) -> tuple[EventArgument, ...] | None:
    """Return the arguments of an event; None if one of them has an unknown type."""
    listed = entry.get("arguments", [])
    if not isinstance(listed, list):
        return None
    found = []
    for each in listed:
        if not isinstance(each, dict):
            return None
        type_name = _text(each, "type")
        enum = enums.get(f"{namespace}::{type_name}") or enums.get(type_name)
        wire_type = type_name if enum is None else enum.type
        if wire_type not in _CODES:
            return None
        found.append(EventArgument(_text(each, "name"), wire_type, enum))
    return tuple(found)


def _enums_of(content: dict[str, Any]) -> Iterator[tuple[str, EventEnum]]:
    """Yield the enums of a namespace by full name: "px4::navigation_mode_t"."""
    namespace = _text(content, "namespace")
    for name, entry in _entries(content.get("enums"), "name"):
        if _text(entry, "type") not in _CODES:
            continue
        values = {}
        for key, each in _entries(entry.get("entries"), "value"):
            value = _whole(key, (1 << 64) - 1)
            if value is not None:
                values[value] = (_text(each, "name"), _text(each, "description"))
        is_bitfield, separator = entry.get("is_bitfield") is True, _text(entry, "separator") or "|"
        enum = EventEnum(str(name), entry["type"], values, is_bitfield, separator)
        yield f"{namespace}::{name}", enum


def _entries(container: object, key: str) -> Iterator[tuple[object, dict[str, Any]]]:
    """Yield key and content of each entry, of an array (version 1) or an object (version 2)."""
    if isinstance(container, dict):
        yield from ((name, each) for name, each in container.items() if isinstance(each, dict))
    elif isinstance(container, list):
        yield from ((each.get(key), each) for each in container if isinstance(each, dict))


def _whole(value: object, maximum: int) -> int | None:
    """Return a number between 0 and `maximum`, or None."""
    if isinstance(value, str) and value.isascii() and value.isdigit() and len(value) <= len(str(maximum)):
        value = int(value)
    return value if isinstance(value, int) and 0 <= value <= maximum else None


def _text(entry: dict[str, Any], key: str) -> str:
    value = entry.get(key)
    return value[:_MAX_TEXT] if isinstance(value, str) else ""
