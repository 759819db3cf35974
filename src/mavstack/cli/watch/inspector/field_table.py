"""The fields of messages as rows: values with units and enum names, raw values, and their course."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.cli.common.field_values import (
    HIDDEN,
    display_format,
    element_text,
    field_texts,
    is_known,
    raw_hex,
)
from mavstack.dialects.secrets import secret_fields

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.cli.watch.inspector.packet_store import StoredPacket
    from mavstack.dialects import Message
    from mavstack.dialects.model import FieldDefinition
    from mavstack.wire import Packet

#: Arrays up to this length have a row for each element.
MAX_ELEMENT_ROWS: Final = 12
#: Number of packets in a field's course, the small chart of its last values.
COURSE_LENGTH: Final = 24


class FieldName(NamedTuple):
    """A field of a message, or one element of its array."""

    field: str
    element: int | None = None

    def __str__(self) -> str:
        return self.field if self.element is None else f"{self.field}[{self.element}]"


@dataclass(frozen=True, slots=True)
class FieldRow:
    """One field: its value as text, its raw value if that differs, and its course, oldest value first."""

    name: FieldName
    text: str
    raw: str = ""
    #: True if the previous packet had another value.
    changed: bool = False
    #: Values of the last packets in the displayed unit; empty if the field is not a number.
    course: Sequence[float | None] = ()

    @property
    def is_number(self) -> bool:
        """True if the field can be plotted."""
        return bool(self.course)


def field_rows(history: Sequence[StoredPacket]) -> list[FieldRow]:
    """Return the fields of the newest packet of a stream.

    Args:
        history: The last packets of the stream, newest first.
    """
    if not history:
        return []
    message = history[0].packet.message
    if message is None:
        return [FieldRow(FieldName("raw"), raw_hex(history[0].packet))]
    shown = history[:COURSE_LENGTH]
    messages = [entry.packet.message for entry in reversed(shown)]
    before = messages[-2] if len(messages) > 1 else None
    whole_texts = {each.name: each.text for each in field_texts(message)}
    return [_row(name, messages, before, whole_texts) for name in field_names(message)]


def field_names(message: Message) -> list[FieldName]:
    """Return the fields of a message, with the elements of short arrays."""
    return [name for field in type(message).definition.fields for name in _names(field, message)]


def _names(field: FieldDefinition, message: Message) -> Iterator[FieldName]:
    secret = field.name in secret_fields(type(message).definition.name)
    if secret or field.array_length > MAX_ELEMENT_ROWS or not isinstance(getattr(message, field.name), tuple):
        yield FieldName(field.name)
    else:
        yield from (FieldName(field.name, index) for index in range(field.array_length))


def _row(
    name: FieldName, messages: Sequence[Message], before: Message | None, whole_texts: dict[str, str]
) -> FieldRow:
    message = messages[-1]
    field = type(message).definition.field(name.field)
    value = field_value(message, name)
    whole = whole_texts[field.name]
    if whole == HIDDEN:
        return FieldRow(name, HIDDEN)
    changed = before is not None and repr(field_value(before, name)) != repr(value)
    if not isinstance(value, int | float):
        return FieldRow(name, whole, changed=changed)
    text = whole if name.element is None else element_text(field, value)
    course = [scaled_value(each, name) for each in messages]
    return FieldRow(name, text, _raw_text(field, value, text), changed, course)


def field_value(message: Message, name: FieldName) -> object:
    """Return the raw value of a field or element."""
    value = getattr(message, name.field)
    return value if name.element is None else value[name.element]


def scaled_value(message: Message, name: FieldName) -> float | None:
    """Return a number in the displayed unit; None if its value is not known, or if it is no number."""
    field = type(message).definition.field(name.field)
    value = field_value(message, name)
    if not isinstance(value, int | float) or not isfinite(value) or not is_known(field, value):
        return None
    return value if field.enum else value * display_format(field).factor


def unit_suffix(packet: Packet, name: FieldName) -> str:
    """Return the displayed unit of a field, with the space before it; empty if it has none."""
    message = packet.message
    field = None if message is None else type(message).definition.by_name.get(name.field)
    return "" if field is None or field.enum else display_format(field).suffix


def _raw_text(field: FieldDefinition, value: float, text: str) -> str:
    """Return the value as on the wire, with its unit; empty if the text says that already."""
    number = f"{value:.7g}" if isinstance(value, float) else str(int(value))
    raw = f"{number} {field.units}".rstrip()
    return "" if text in (raw, number) else raw
