"""The fields of requests as typed models: msgspec checks them, and the OpenAPI document describes them.

A model is a subclass of `Fields`. The annotations of its fields hold their limits and their meaning:

    class Takeoff(Fields):
        altitude: Annotated[float, Meta(description="Metres above home.", ge=0)] = 10.0
"""

from __future__ import annotations

from difflib import get_close_matches
from math import isfinite
from typing import TYPE_CHECKING, Any, TypeVar, dataclass_transform

from mavstack.errors import MissingExtraError
from mavstack.http.bodies import RefusedError

try:
    from msgspec import UNSET, Struct, ValidationError, convert
    from msgspec.json import schema
    from msgspec.structs import fields
except ImportError as error:
    raise MissingExtraError("an HTTP server", "web") from error

if TYPE_CHECKING:
    from collections.abc import Mapping


# For type checkers: the options of this class also apply to its subclasses.
@dataclass_transform(kw_only_default=True, frozen_default=True)
class Fields(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The fields of a JSON body, or of a query; a subclass declares them."""


Model = TypeVar("Model", bound=Fields)


def read_fields(model: type[Model], values: Mapping[str, Any]) -> Model:
    """Return the checked fields of a JSON body.

    Args:
        model: The fields that the body may have.
        values: The members of the body; null is the default, unless the default is a missing member.

    Returns:
        The model with the values.

    Raises:
        RefusedError: A member is unknown, missing or not valid.
    """
    return _read(model, values, strict=True)


def read_query(model: type[Model], values: Mapping[str, str]) -> Model:
    """Return the checked fields of a query, whose values are texts; see `read_fields`."""
    found = _read(model, values, strict=False)
    for name in values:
        value = getattr(found, name)
        if isinstance(value, float) and not isfinite(value):
            raise RefusedError(400, f"{name} must be finite, got {value}")
    return found


def _read(model: type[Model], values: Mapping[str, Any], *, strict: bool) -> Model:
    kept = {each.encode_name for each in fields(model) if each.default is UNSET}
    given = {name: value for name, value in values.items() if value is not None or name in kept}
    try:
        return convert(given, model, strict=strict)
    except ValidationError as error:
        raise RefusedError(400, _problem(model, given, strict=strict) or str(error)) from None


def _problem(model: type[Fields], values: Mapping[str, Any], *, strict: bool) -> str | None:
    """Return the problem of the first field that has one."""
    known = {each.encode_name: each for each in fields(model)}
    for name in values:
        if name not in known:
            return _unknown(name, list(known))
    for name, each in known.items():
        if name not in values:
            if each.required:
                return f"{name} is missing: {schema(each.type).get('description', 'it has no default')}"
            continue
        try:
            convert(values[name], each.type, strict=strict)
        except ValidationError:
            return f"{name} must be {allowed_values(schema(each.type))}, got {_shown(values[name])}"
    return None


def _unknown(name: str, known: list[str]) -> str:
    close = get_close_matches(name, known, 1)
    if close:
        return f"there is no field {_shown(name)}: did you mean {close[0]}?"
    return f"there is no field {_shown(name)}: {_listed(known)}"


def _listed(known: list[str]) -> str:
    return f"there are {', '.join(known)}" if known else "the request takes none"


def allowed_values(field: Mapping[str, Any]) -> str:
    """Return the values that a JSON Schema allows, in words."""
    match field:
        case {"anyOf": kinds}:
            return " or ".join(allowed_values(each) for each in kinds if each != {"type": "null"})
        case {"enum": choices}:
            return f"one of {', '.join(map(str, choices))}"
        case {"type": "boolean"}:
            return "true or false"
        case {"type": "string"}:
            length = f" of at most {field['maxLength']} characters" if "maxLength" in field else ""
            return f"a string{length}" + (f" that fits {field['pattern']}" if "pattern" in field else "")
        case {"type": "array", "prefixItems": kinds}:
            each = " and ".join(dict.fromkeys(allowed_values(kind) for kind in kinds))
            return f"an array of {len(kinds)} values, each {each}"
        case {"type": "array"}:
            length = f" of at most {field['maxItems']} values" if "maxItems" in field else ""
            return f"an array{length}, each {allowed_values(field['items'])}"
        case {"type": "object"} | {"$ref": _}:
            return "an object"
        case _:
            return ("an integer" if field.get("type") == "integer" else "a number") + _range(field)


def _range(field: Mapping[str, Any]) -> str:
    match field:
        case {"minimum": low, "maximum": high}:
            return f" from {low:g} to {high:g}"
        case {"minimum": low}:
            return f" of at least {low:g}"
        case {"maximum": high}:
            return f" of at most {high:g}"
    return ""


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:59]}…"
