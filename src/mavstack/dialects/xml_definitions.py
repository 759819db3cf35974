"""Parsing of one MAVLink XML file to a `DialectDefinition`, without following its includes.

The schema is that of MAVLink. Unknown elements and attributes are skipped, as by other readers of these
files; an invalid type, number, length or a duplicate name is a `DialectError` with its line.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NoReturn

from mavstack.dialects.layout import (
    MAX_FIELDS,
    MAX_MESSAGE_ID,
    MAX_PAYLOAD,
    assign_offsets,
    crc_extra,
    lengths,
)
from mavstack.dialects.model import (
    TYPE_SIZES,
    DialectDefinition,
    EnumDefinition,
    EnumEntry,
    EnumParam,
    FieldDefinition,
    MessageDefinition,
    Number,
    Replacement,
)
from mavstack.dialects.xml_reader import Element, read_tree
from mavstack.errors import DialectError

if TYPE_CHECKING:
    from collections.abc import Iterator

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,127}", re.ASCII)
_MAX_PROBLEM_LENGTH = 300
_TYPE = re.compile(r"([a-z0-9_]+?)(_mavlink_version)?(?:\[([0-9]+)\])?", re.ASCII)
_INTEGER = re.compile(
    r"(-?[0-9]{1,20})|0[xX]([0-9a-fA-F]{1,16})|0[bB]([01]{1,64})|2\*\*([0-9]{1,2})", re.ASCII
)


_REMARKS = frozenset({"deprecated", "superseded", "wip", "description"})
_PARAM_TEXTS = frozenset({"label", "units", "multiplier", "enum", "default"})
_FIELD_TEXTS = frozenset({"enum", "units", "multiplier", "invalid", "print_format", "display", "default"})
#: Attributes of the definition classes, by the name of the XML attribute.
_LIMITS = {"minValue": "minimum", "maxValue": "maximum", "increment": "increment"}
_FLAGS = {
    "hasLocation": "has_location",
    "isDestination": "is_destination",
    "hasAltitudeOnly": "has_altitude_only",
    "missionOnly": "mission_only",
    "mission": "mission",
    "fence": "fence",
    "rally": "rally",
    "command": "command",
}


@lru_cache(maxsize=64)
def parse_definition(data: bytes, path: str, name: str) -> DialectDefinition:
    """Parse a definition; equal data gives the same object, so that its classes are created once."""
    return _Reader(path, name).dialect(read_tree(data, path))


def _integer(text: str) -> int | None:
    """Parse a decimal, hexadecimal, binary or `2**n` number."""
    match = _INTEGER.fullmatch(text.strip())
    if match is None:
        return None
    decimal, hexadecimal, binary, power = match.groups()
    if decimal:
        return int(decimal)
    if power:
        return 1 << int(power)
    return int(hexadecimal, 16) if hexadecimal else int(binary, 2)


class _Reader:
    """Reader of the elements of one file; its errors name the file and the line."""

    def __init__(self, path: str, name: str) -> None:
        self.path = path
        self.name = name

    def fail(self, problem: str, element: Element) -> NoReturn:
        if len(problem) > _MAX_PROBLEM_LENGTH:
            problem = f"{problem[:100]} ... {problem[-100:]}"
        raise DialectError(problem, self.path, element.line)

    def attribute(self, element: Element, key: str) -> str:
        value = element.attributes.get(key, "").strip()
        if not value:
            self.fail(f"<{element.tag}> without {key!r}", element)
        return value

    def identifier(self, element: Element) -> str:
        return self.name_in(element, self.attribute(element, "name"), element.tag)

    def name_in(self, element: Element, name: str, noun: str) -> str:
        if not _NAME.fullmatch(name):
            self.fail(f"{name!r} is not a valid name for a {noun}", element)
        return name

    def integer(self, element: Element, text: str, noun: str, low: int, high: int) -> int:
        value = _integer(text)
        if value is None:
            self.fail(f"{noun} {text!r} is not an integer", element)
        if not low <= value <= high:
            self.fail(f"{noun} {value} is outside {low} to {high}", element)
        return value

    def number(self, element: Element, key: str) -> Number | None:
        text = element.attributes.get(key)
        if text is None:
            return None
        value = _integer(text)
        try:
            return float(text) if value is None else value
        except ValueError:
            self.fail(f"{key} {text!r} is not a number", element)

    def flag(self, element: Element, key: str) -> bool:
        text = element.attributes.get(key)
        if text is None:
            return False
        text = text.strip().lower()
        if text not in ("true", "false", "1", "0"):
            self.fail(f"{key} {text!r} is neither true nor false", element)
        return text in ("true", "1")

    def dialect(self, root: Element) -> DialectDefinition:
        if root.tag != "mavlink":
            self.fail(f"the root element is <{root.tag}>, not <mavlink>", root)
        includes = tuple(self.includes(root))
        return DialectDefinition(
            name=self.name,
            version=self.header_number(root, "version"),
            number=self.header_number(root, "dialect"),
            includes=tuple(name for name, _ in includes),
            messages=tuple(self.messages(root)),
            enums=tuple(self.enums(root)),
            path=self.path,
            include_lines=tuple(line for _, line in includes),
        )

    def header_number(self, root: Element, tag: str) -> int | None:
        element = root.first(tag)
        return None if element is None else self.integer(element, element.text, f"<{tag}>", 0, 255)

    def includes(self, root: Element) -> Iterator[tuple[str, int]]:
        for element in root.named("include"):
            if not element.text or "\0" in element.text or "://" in element.text:
                self.fail(f"<include> is no file name: {element.text!r}", element)
            yield element.text, element.line

    def messages(self, root: Element) -> Iterator[MessageDefinition]:
        ids: dict[int, MessageDefinition] = {}
        names: dict[str, MessageDefinition] = {}
        for group in root.named("messages"):
            for element in group.named("message"):
                message = self.message(element)
                other = ids.setdefault(message.id, message)
                if other is not message:
                    self.fail(f"message id {message.id} is already used by {other.name}", element)
                if names.setdefault(message.name, message) is not message:
                    self.fail(f"message {message.name} is defined twice", element)
                yield message

    def message(self, element: Element) -> MessageDefinition:
        name = self.identifier(element)
        number = self.integer(element, self.attribute(element, "id"), "message id", 0, MAX_MESSAGE_ID)
        fields = self.fields(element, name)
        base, total = lengths(fields)
        if total > MAX_PAYLOAD:
            self.fail(f"{name} has {total} bytes; the maximum payload is {MAX_PAYLOAD}", element)
        return MessageDefinition(
            id=number,
            name=name,
            crc_extra=crc_extra(name, fields),
            fields=assign_offsets(fields),
            base_length=base,
            length=total,
            origin=self.name,
            line=element.line,
            **self.remarks(element),
        )

    def fields(self, message: Element, name: str) -> list[FieldDefinition]:
        found: dict[str, FieldDefinition] = {}
        extension = False
        for element in message.children:
            if element.tag == "extensions":
                if extension:
                    self.fail(f"{name} has a second <extensions/>", element)
                extension = True
            if element.tag != "field":
                continue
            item = self.field(element, extension)
            if item.name in found:
                self.fail(f"{name} has two fields called {item.name!r}", element)
            found[item.name] = item
        if not 0 < len(found) <= MAX_FIELDS:
            self.fail(f"{name} has {len(found)} fields; it must have 1 to {MAX_FIELDS}", message)
        return list(found.values())

    def field(self, element: Element, extension: bool) -> FieldDefinition:
        kind, array_length, protocol_version = self.type(element)
        texts = self.texts(element, _FIELD_TEXTS)
        if texts.get("enum"):
            self.name_in(element, texts["enum"], "enum")
        item = FieldDefinition(
            name=self.identifier(element),
            type=kind,
            array_length=array_length,
            extension=extension,
            protocol_version=protocol_version,
            description=self.description(element),
            line=element.line,
            **texts,
            **self.limits(element),
        )
        if item.multiplier:
            self.check_factor(item, element)
        return item

    def texts(self, element: Element, names: frozenset[str]) -> dict[str, Any]:
        """Return the attributes of these names, as far as they are given."""
        return {key: element.attributes[key].strip() for key in names & element.attributes.keys()}

    def limits(self, element: Element) -> dict[str, Any]:
        """Return the numbers and the mark that fields and params have in common, as far as they are given."""
        known = _LIMITS.keys() & element.attributes.keys()
        limits: dict[str, Any] = {_LIMITS[key]: self.number(element, key) for key in known}
        if "instance" in element.attributes:
            limits["instance"] = self.flag(element, "instance")
        return limits

    def type(self, element: Element) -> tuple[str, int, bool]:
        text = self.attribute(element, "type")
        if text in TYPE_SIZES:
            return text, 0, False
        match = _TYPE.fullmatch(text)
        if match is None or match[1] not in TYPE_SIZES or (match[2] and (match[1] != "uint8_t" or match[3])):
            self.fail(f"unknown field type {text!r}", element)
        if match[3] is None:
            return match[1], 0, match[2] is not None
        return match[1], self.integer(element, match[3], "array length", 1, MAX_PAYLOAD), False

    def check_factor(self, item: FieldDefinition, element: Element) -> None:
        try:
            _ = item.factor
        except (ValueError, ZeroDivisionError):
            self.fail(f"multiplier {item.multiplier!r} is not a number or a fraction", element)

    def enums(self, root: Element) -> Iterator[EnumDefinition]:
        found: dict[str, EnumDefinition] = {}
        for group in root.named("enums"):
            for element in group.named("enum"):
                enum = self.enum(element)
                if enum.name in found:
                    self.fail(f"enum {enum.name} is defined twice in one file", element)
                found[enum.name] = enum
        return iter(found.values())

    def enum(self, element: Element) -> EnumDefinition:
        name = self.identifier(element)
        return EnumDefinition(
            name=name,
            entries=tuple(self.entries(element, name)),
            bitmask=self.flag(element, "bitmask"),
            line=element.line,
            **self.remarks(element),
        )

    def entries(self, enum: Element, enum_name: str) -> Iterator[EnumEntry]:
        names: set[str] = set()
        values: dict[int, str] = {}
        highest = 0
        for element in enum.named("entry"):
            entry = self.entry(element, highest + 1)
            highest = max(highest, entry.value)
            if entry.name in names:
                self.fail(f"enum {enum_name} has two entries called {entry.name}", element)
            if entry.value in values:
                self.fail(
                    f"enum {enum_name} has the value {entry.value} twice: "
                    f"{values[entry.value]} and {entry.name}",
                    element,
                )
            names.add(entry.name)
            values[entry.value] = entry.name
            yield entry

    def entry(self, element: Element, next_value: int) -> EnumEntry:
        text = element.attributes.get("value")
        if text is not None:
            next_value = self.integer(element, text, "enum value", -(2**63), 2**64 - 1)
        return EnumEntry(
            name=self.identifier(element),
            value=next_value,
            params=tuple(self.params(element)) if element.children else (),
            automatic=text is None,
            line=element.line,
            **self.flags(element),
            **self.remarks(element),
        )

    def flags(self, entry: Element) -> dict[str, Any]:
        """Return the flags that an entry of a command has."""
        found = _FLAGS.keys() & entry.attributes.keys()
        return {_FLAGS[key]: self.flag(entry, key) for key in found}

    def params(self, entry: Element) -> Iterator[EnumParam]:
        seen: set[int] = set()
        for element in entry.named("param"):
            index = self.integer(element, self.attribute(element, "index"), "param index", 1, 255)
            if index in seen:
                self.fail(f"param {index} is given twice", element)
            seen.add(index)
            places = element.attributes.get("decimalPlaces")
            yield EnumParam(
                index=index,
                decimal_places=None
                if places is None
                else self.integer(element, places, "decimalPlaces", 0, 255),
                reserved=self.flag(element, "reserved"),
                description=element.text,
                **self.texts(element, _PARAM_TEXTS),
                **self.limits(element),
            )

    def remarks(self, element: Element) -> dict[str, Any]:
        """Return the description and the marks of a message, enum or entry, as far as they are given."""
        children = {child.tag: child for child in reversed(element.children) if child.tag in _REMARKS}
        found: dict[str, Any] = {}
        for tag, child in children.items():
            if tag == "description":
                found[tag] = child.text
            elif tag == "wip":
                found |= {"wip": True, "wip_since": child.attributes.get("since", "")}
            else:
                found[tag] = self.replacement(child)
        if "description" not in found:
            found["description"] = element.text
        return found

    def replacement(self, mark: Element) -> Replacement:
        texts = mark.attributes
        return Replacement(
            since=texts.get("since", "").strip(),
            replaced_by=texts.get("replaced_by", "").strip(),
            description=self.description(mark),
        )

    def description(self, element: Element) -> str:
        child = element.first("description") if element.children else None
        return element.text if child is None else child.text
