"""Invalid values of fields ("unknown"), and conversion of raw values to units.

A definition marks the invalid value of a field as a number, a name such as UINT16_MAX or NaN, or an enum
entry. For an array, `[x]` marks every element equal to x, `[x:]` all elements if the first one is x, and
`[x,y,]` each element by position, where an empty position has no invalid value.
"""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mavstack.dialects.message import Message
    from mavstack.dialects.model import FieldDefinition


def is_invalid(message: Message, name: str) -> bool:
    """Return whether a field has its invalid value.

    Args:
        message: The message.
        name: Attribute name of the field.

    Returns:
        True if the value, or every element of an array, is marked as invalid.
    """
    flags = invalid_elements(message, name)
    return bool(flags) and all(flags)


def invalid_elements(message: Message, name: str) -> tuple[bool, ...]:
    """Return which elements of a field have their invalid value.

    Args:
        message: The message.
        name: Attribute name of the field.

    Returns:
        True or False for each element; one element for a single value.
    """
    item, value = _item(message, name), getattr(message, name)
    elements = value if isinstance(value, tuple | bytes) else (value,)
    entries = message.__mavlink_dialect__.enum_values(item.enum) if item.enum else {}
    markers = _markers(item, len(elements), entries, elements)
    return tuple(map(_equals, elements, markers))


def scaled_value(message: Message, name: str) -> float | tuple[float | None, ...] | None:
    """Return the value of a field in its units, by the multiplier of the definition.

    Args:
        message: The message.
        name: Attribute name of the field.

    Returns:
        The value or a tuple of values; None for an invalid value.
    """
    item, value = _item(message, name), getattr(message, name)
    flags = invalid_elements(message, name)
    elements = value if isinstance(value, tuple | bytes) else (value,)
    results = tuple(
        None if unknown else element * item.factor if item.multiplier else element
        for element, unknown in zip(elements, flags, strict=True)
    )
    return results if isinstance(value, tuple | bytes) else results[0]


def invalid_markers(
    item: FieldDefinition, entries: Mapping[str, int]
) -> tuple[tuple[float | None, ...], float | None]:
    """Return the invalid values of a field, for programs that examine many values at once.

    Args:
        item: The definition of the field.
        entries: The values of its enum by entry name; empty if it has none.

    Returns:
        The invalid value that holds for all elements as a tuple of one, or that of each element, or an empty
        tuple; and the value of the first element that marks all elements as invalid, or None.
    """
    inside = item.invalid.strip("[]")
    if item.invalid.startswith("[") and inside.endswith(":"):
        return (), _number(inside[:-1], entries)
    if item.invalid.startswith("[") and "," in inside:
        return tuple(_number(part, entries) for part in inside.split(","))[: max(item.array_length, 1)], None
    marker = _number(inside, entries)
    return (() if marker is None else (marker,)), None


def _item(message: Message, name: str) -> FieldDefinition:
    return message.definition.fields[message.__match_args__.index(name)]


def _markers(
    item: FieldDefinition, count: int, entries: Mapping[str, int], elements: Sequence[object]
) -> list[float | None]:
    """Return the invalid value of each element, or None."""
    text = item.invalid
    if not text.startswith("["):
        return [_number(text, entries)] * count
    inside = text.strip("[]")
    if inside.endswith(":"):
        first = _number(inside[:-1], entries)
        return (
            [_as_marker(element) for element in elements] if _equals(elements[0], first) else [None] * count
        )
    if "," not in inside:
        return [_number(inside, entries)] * count
    positions = [_number(part, entries) for part in inside.split(",")][:count]
    return positions + [None] * (count - len(positions))


def _as_marker(element: object) -> float | None:
    return element if isinstance(element, int | float) else None


def _number(text: str, entries: Mapping[str, int]) -> float | None:
    """Parse an invalid value; return None if there is none."""
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


def _equals(element: object, marker: float | None) -> bool:
    if marker is None or not isinstance(element, int | float):
        return False
    return isnan(element) if isnan(marker) else element == marker
