"""Schemas as text: `ros2msg` of MCAP and Foxglove, and JSON Schema."""

from __future__ import annotations

from functools import cache
from typing import Any, Final

from mavstack.bridges.core.types.definitions import definition_of
from mavstack.bridges.core.types.hashes import referenced
from mavstack.bridges.core.types.model import Container, Definition, Field, FieldType

_SEPARATOR: Final = "=" * 80


@cache
def message_text(name: str) -> str:
    """Return a message in the form of a .msg file, with all messages that it refers to (`ros2msg`).

    Args:
        name: The full name, such as "sensor_msgs/msg/Imu".

    Returns:
        The text; each referenced message follows a line of 80 equals signs and a line with `MSG:`.
    """
    parts = [_text(definition_of(name))]
    parts += [f"{_SEPARATOR}\nMSG: {_short(each.name)}\n{_text(each)}" for each in referenced(name)]
    return "".join(parts)


@cache
def json_schema(name: str) -> dict[str, Any]:
    """Return the JSON Schema of a message whose fields are the keys of an object.

    Args:
        name: The full name, such as "sensor_msgs/msg/Imu".

    Returns:
        The schema, with nested messages inline.
    """
    definition = definition_of(name)
    return {"title": name, **_object(definition)}


def _text(definition: Definition) -> str:
    constants = [f"{each.type} {each.name}={each.value}" for each in definition.constants]
    fields = [f"{_type_text(each.type)} {each.name} {each.default}".rstrip() for each in definition.fields]
    return "".join(f"{line}\n" for line in constants + fields)


def _type_text(field: FieldType) -> str:
    base = _short(field.base) if field.is_message else field.base
    base += f"<={field.text_bound}" if field.text_bound else ""
    brackets = {
        Container.ONE: "",
        Container.ARRAY: f"[{field.size}]",
        Container.BOUNDED: f"[<={field.size}]",
        Container.SEQUENCE: "[]",
    }
    return base + brackets[field.container]


def _short(name: str) -> str:
    package, _, last = name.split("/")
    return f"{package}/{last}"


def _object(definition: Definition) -> dict[str, Any]:
    properties = {field.name: _property(field) for field in definition.fields}
    return {"type": "object", "properties": properties}


def _property(field: Field) -> dict[str, Any]:
    one = _object(definition_of(field.type.base)) if field.type.is_message else _primitive(field.type.base)
    if field.type.container is Container.ONE:
        return one
    found: dict[str, Any] = {"type": "array", "items": one}
    if field.type.container is Container.ARRAY:
        found |= {"minItems": field.type.size, "maxItems": field.type.size}
    elif field.type.container is Container.BOUNDED:
        found["maxItems"] = field.type.size
    return found


def _primitive(base: str) -> dict[str, Any]:
    if base in ("float32", "float64"):
        return {"type": ["number", "null"]}  # null for NaN, which JSON does not have
    return {"type": {"bool": "boolean", "string": "string"}.get(base, "integer")}
