"""JSON on buses: values of the API as strict JSON, and requests that are checked.

Numbers that are not finite are null, since JSON has none; members of an enum are their names, flags are
numbers, bytes are arrays of numbers.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum, Flag
from math import isfinite
from typing import Any, Final

from mavstack.errors import InvalidArgumentError

#: Maximum size of a request in bytes; a plan with some thousand items is much smaller.
MAX_REQUEST: Final = 1 << 20
#: Types of most values, which need no conversion: this lookup is faster than the cases with abstract classes.
_PLAIN: Final = frozenset({type(None), bool, int, str})
_ENCODER: Final = json.JSONEncoder(ensure_ascii=False, separators=(",", ":"), allow_nan=False)


def plain(value: object) -> Any:
    """Return a value as JSON has it: None, a bool, a number, a text, a list or a dictionary."""
    if type(value) in _PLAIN:
        return value
    if isinstance(value, float):
        return value if isfinite(value) else None
    match value:
        case None | bool() | str():
            return value
        case Flag():
            return value.value
        case Enum():
            return value.name.lstrip("_") if isinstance(value, int) else plain(value.value)
        case int():
            return int(value)
        case Mapping():
            return {str(plain(key)): plain(each) for key, each in value.items()}
        case Iterable():
            return [plain(each) for each in value]
    if is_dataclass(value) and not isinstance(value, type):
        return {each.name: plain(getattr(value, each.name)) for each in fields(value)}
    return str(value)


def json_bytes(value: object) -> bytes:
    """Return a value as compact JSON in UTF-8."""
    text = _ENCODER.encode(plain(value))
    return text.encode("utf-8", "backslashreplace")  # a lone surrogate becomes a JSON escape


def parse_object(data: bytes) -> dict[str, Any]:
    """Return the JSON object in some bytes; no bytes are an empty one.

    Raises:
        InvalidArgumentError: They are not a JSON object, hold a number that is not finite, or are too many.
    """
    if len(data) > MAX_REQUEST:
        raise InvalidArgumentError(f"the request has {len(data)} bytes, at most {MAX_REQUEST} are allowed")
    if not data.strip():
        return {}
    try:
        found = json.loads(data, parse_constant=_refuse_constant, parse_float=_finite)
    except (ValueError, RecursionError) as error:
        raise InvalidArgumentError(f"the request is not JSON: {error}") from None
    if not isinstance(found, dict):
        raise InvalidArgumentError("the request must be a JSON object")
    return found


def _refuse_constant(name: str) -> float:
    raise ValueError(f"numbers must be finite, got {name}")


def _finite(text: str) -> float:
    number = float(text)
    return number if isfinite(number) else _refuse_constant(text)
