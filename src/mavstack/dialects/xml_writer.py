"""Writing of a `DialectDefinition` as XML in MAVLink's schema.

Of all descriptions only the line of each message is written. Equal definitions give equal text, byte for
byte, so that a new import is a readable difference.
"""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape, quoteattr

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.dialects.model import (
        DialectDefinition,
        EnumDefinition,
        EnumEntry,
        EnumParam,
        FieldDefinition,
        MessageDefinition,
        Number,
        Replacement,
    )

_NOTE = "Facts of MAVLink's definition, by mavstack.dialects.importer. A message's line is Mavstack's own."


def definition_xml(definition: DialectDefinition, descriptions: Mapping[str, str]) -> str:
    """Return the file as text; `descriptions` are the lines of messages by name."""
    return "\n".join(_lines(definition, descriptions)) + "\n"


def _lines(definition: DialectDefinition, descriptions: Mapping[str, str]) -> Iterator[str]:
    yield '<?xml version="1.0"?>'
    yield f"<!-- {_NOTE} -->"
    yield "<mavlink>"
    for include in definition.includes:
        yield f"  <include>{escape(include)}</include>"
    if definition.version is not None:
        yield f"  <version>{definition.version}</version>"
    if definition.number is not None:
        yield f"  <dialect>{definition.number}</dialect>"
    if definition.enums:
        yield "  <enums>"
        for enum in definition.enums:
            yield from _enum(enum)
        yield "  </enums>"
    if definition.messages:
        yield "  <messages>"
        for message in definition.messages:
            yield from _message(message, descriptions.get(message.name, ""))
        yield "  </messages>"
    yield "</mavlink>"


def _tag(tag: str, **attributes: str | Number | bool | None) -> str:
    """Return an opening tag without its end; empty, absent and false attributes are omitted."""
    parts = [f"<{tag}"]
    for name, value in attributes.items():
        if value is not None and value is not False and value != "":
            parts.append(f"{name}={quoteattr(_text(value))}")
    return " ".join(parts)


def _text(value: str | Number | bool) -> str:
    if isinstance(value, bool):
        return "true"
    if isinstance(value, float):
        return "NaN" if isnan(value) else f"{value:.15g}"
    return str(value)


def _marks(value: MessageDefinition | EnumDefinition | EnumEntry, indent: str) -> Iterator[str]:
    if value.wip:
        yield f"{indent}{_tag('wip', since=value.wip_since)}/>"
    for tag, mark in (("superseded", value.superseded), ("deprecated", value.deprecated)):
        if mark is not None:
            yield indent + _replacement(tag, mark)


def _replacement(tag: str, mark: Replacement) -> str:
    return f"<{tag} since={quoteattr(mark.since)} replaced_by={quoteattr(mark.replaced_by)}/>"


def _enum(enum: EnumDefinition) -> Iterator[str]:
    yield f"    {_tag('enum', name=enum.name, bitmask=enum.bitmask)}>"
    yield from _marks(enum, "      ")
    for entry in enum.entries:
        yield from _entry(entry)
    yield "    </enum>"


def _entry(entry: EnumEntry) -> Iterator[str]:
    opening = _tag(
        "entry",
        value=None if entry.automatic else entry.value,
        name=entry.name,
        hasLocation=entry.has_location,
        hasAltitudeOnly=entry.has_altitude_only,
        isDestination=entry.is_destination,
        missionOnly=entry.mission_only,
        mission=entry.mission,
        fence=entry.fence,
        rally=entry.rally,
        command=entry.command,
    )
    inside = [*_marks(entry, "        "), *(f"        {_param(param)}/>" for param in entry.params)]
    if not inside:
        yield f"      {opening}/>"
        return
    yield f"      {opening}>"
    yield from inside
    yield "      </entry>"


def _param(param: EnumParam) -> str:
    return _tag(
        "param",
        index=param.index,
        label=param.label,
        units=param.units,
        multiplier=param.multiplier,
        instance=param.instance,
        enum=param.enum,
        decimalPlaces=param.decimal_places,
        increment=param.increment,
        minValue=param.minimum,
        maxValue=param.maximum,
        reserved=param.reserved,
        default=param.default,
    )


def _message(message: MessageDefinition, description: str) -> Iterator[str]:
    yield f"    {_tag('message', id=message.id, name=message.name)}>"
    yield from _marks(message, "      ")
    if description:
        yield f"      <description>{escape(description)}</description>"
    extension = False
    for item in message.fields:
        if item.extension and not extension:
            yield "      <extensions/>"
            extension = True
        yield f"      {_field(item)}/>"
    yield "    </message>"


def _field(item: FieldDefinition) -> str:
    kind = "uint8_t_mavlink_version" if item.protocol_version else item.type
    return _tag(
        "field",
        type=f"{kind}[{item.array_length}]" if item.array_length else kind,
        name=item.name,
        print_format=item.print_format,
        enum=item.enum,
        display=item.display,
        units=item.units,
        increment=item.increment,
        minValue=item.minimum,
        maxValue=item.maximum,
        multiplier=item.multiplier,
        default=item.default,
        instance=item.instance,
        invalid=item.invalid,
    )
