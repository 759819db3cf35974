"""What a field's raw value means: whether it stands for "not known", and its value in the field's units.

A definition marks a field's invalid value as a number, a name such as UINT16_MAX or NaN, or an enum entry.
For an array, `[x]` marks every element that is x, `[x:]` all elements if the first is x, and `[x,y,]` each
element by its place, an empty place having no invalid value.
"""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mavstack.dialects.message import Message
    from mavstack.dialects.model import FieldDefinition


def is_invalid(message: Message, name: str) -> bool:
    """Whether a field, or every element of an array, is marked as not known."""
    flags = invalid_elements(message, name)
    return bool(flags) and all(flags)


def invalid_elements(message: Message, name: str) -> tuple[bool, ...]:
    """For each element of a field (one for a plain field) whether it is marked as not known."""
    item, value = _item(message, name), getattr(message, name)
    elements = value if isinstance(value, tuple | bytes) else (value,)
    entries = message.__mavlink_dialect__.enum_values(item.enum) if item.enum else {}
    markers = _markers(item, len(elements), entries, elements)
    return tuple(map(_same, elements, markers))


def scaled(message: Message, name: str) -> float | tuple[float | None, ...] | None:
    """A field's value multiplied into its units; `None` where it is marked as not known."""
    item, value = _item(message, name), getattr(message, name)
    flags = invalid_elements(message, name)
    elements = value if isinstance(value, tuple | bytes) else (value,)
    results = tuple(
        None if unknown else element * item.factor if item.multiplier else element
        for element, unknown in zip(elements, flags, strict=True)
    )
    return results if isinstance(value, tuple | bytes) else results[0]


def _item(message: Message, name: str) -> FieldDefinition:
    return message.definition.fields[message.__match_args__.index(name)]


def _markers(
    item: FieldDefinition, count: int, entries: Mapping[str, int], elements: Sequence[object]
) -> list[float | None]:
    """The invalid value of each element, or `None`."""
    text = item.invalid
    if not text.startswith("["):
        return [_number(text, entries)] * count
    inside = text.strip("[]")
    if inside.endswith(":"):
        first = _number(inside[:-1], entries)
        return [_as_marker(element) for element in elements] if _same(elements[0], first) else [None] * count
    if "," not in inside:
        return [_number(inside, entries)] * count
    places = [_number(part, entries) for part in inside.split(",")][:count]
    return places + [None] * (count - len(places))


def _as_marker(element: object) -> float | None:
    return element if isinstance(element, int | float) else None


def _number(text: str, entries: Mapping[str, int]) -> float | None:
    """The value that a marker stands for; `None` if it stands for none."""
    text = text.strip()
    if text in entries:
        return entries[text]
    kind, _, end = text.partition("_")
    bits = kind.removeprefix("U").removeprefix("INT")
    if end in ("MAX", "MIN") and bits.isdecimal():
        signed = not kind.startswith("U")
        high, low = (1 << (int(bits) - signed)) - 1, -(1 << (int(bits) - 1)) if signed else 0
        return high if end == "MAX" else low
    try:
        return int(text, 0)
    except ValueError:
        pass
    try:
        return float(text)
    except ValueError:
        return None


def _same(element: object, marker: float | None) -> bool:
    if marker is None or not isinstance(element, int | float):
        return False
    return isnan(element) if isnan(marker) else element == marker
