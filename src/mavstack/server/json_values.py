"""Values of the API as JSON.

Numbers that are not finite are null, since JSON has none. Members of an enum are their names in the
definition, such as "3D_FIX"; flags stay numbers. Arrays of bytes are arrays of numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum, Flag
from math import isfinite
from typing import Any

from msgspec import Struct


def to_json(value: object) -> Any:  # noqa: ANN401 (JSON has values of many types)
    """Return a value as JSON has it.

    Args:
        value: A value of the API: a number, a text, an enum member, a dataclass, a collection of them.

    Returns:
        None, a bool, a number, a text, a list or a dictionary.
    """
    kind = type(value)
    if kind is float:  # check floats and integers first: most values are of these types
        return value if isfinite(value) else None  # type: ignore[arg-type]
    return value if kind is int or kind is str else _other_json(value)


def _other_json(value: object) -> Any:  # noqa: ANN401
    match value:
        case None | bool():
            return value
        case Flag():
            return value.value
        case Enum():
            return _official_name(value.name) if isinstance(value, int) else to_json(value.value)
        case float():
            return value if isfinite(value) else None
        case int() | str():
            return int(value) if isinstance(value, int) else str(value)
        case Mapping():
            return {str(to_json(key)): to_json(each) for key, each in value.items()}
        case Iterable():
            return [to_json(each) for each in value]
    if isinstance(value, Struct):
        return {name: to_json(getattr(value, name)) for name in value.__struct_fields__}
    if is_dataclass(value) and not isinstance(value, type):
        return {each.name: to_json(getattr(value, each.name)) for each in fields(value)}
    return str(value)


def _official_name(name: str) -> str:
    """Return the definition's name of a member: a name in Python cannot begin with a digit."""
    return name[1:] if name[:1] == "_" and name[1:2].isdigit() else name
