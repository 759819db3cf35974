"""Type hashes RIHS01: SHA-256 of a canonical JSON of the type description (REP 2016).

Zenoh keys hold them, so that peers with different definitions of a type never meet.
"""

from __future__ import annotations

import json
from functools import cache
from hashlib import sha256
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.types.definitions import definition_of
from mavstack.bridges.core.types.model import Container, Definition, FieldType

if TYPE_CHECKING:
    from collections.abc import Mapping

_MESSAGE: Final = 1
_BOUNDED_TEXT: Final = 21
#: The numbers of type_description_interfaces/msg/FieldType.
_IDS: Final[Mapping[str, int]] = MappingProxyType(
    {
        "int8": 2,
        "uint8": 3,
        "int16": 4,
        "uint16": 5,
        "int32": 6,
        "uint32": 7,
        "int64": 8,
        "uint64": 9,
        "float32": 10,
        "float64": 11,
        "char": 3,
        "bool": 15,
        "byte": 16,
        "string": 17,
    }
)
_OFFSETS: Final = MappingProxyType(
    {Container.ONE: 0, Container.ARRAY: 48, Container.BOUNDED: 96, Container.SEQUENCE: 144}
)


@cache
def type_hash(name: str) -> str:
    """Return the type hash of an interface, such as "RIHS01_7d9a00ff…".

    Args:
        name: The full name of a message, service or action.

    Returns:
        The hash.

    Raises:
        InvalidArgumentError: There is no such interface.
    """
    definition = definition_of(name)
    others = {each.name: each for each in _referenced(definition)}
    description = {
        "type_description": _individual(definition),
        "referenced_type_descriptions": [_individual(others[key]) for key in sorted(others)],
    }
    text = json.dumps(description, ensure_ascii=True, separators=(", ", ": "))
    return f"RIHS01_{sha256(text.encode()).hexdigest()}"


def referenced(name: str) -> tuple[Definition, ...]:
    """Return the definitions that a definition refers to, directly and indirectly, sorted by name."""
    found = {each.name: each for each in _referenced(definition_of(name))}
    return tuple(found[key] for key in sorted(found))


def _referenced(definition: Definition) -> list[Definition]:
    nested = [definition_of(field.type.base) for field in definition.fields if field.type.is_message]
    return nested + [deeper for each in nested for deeper in _referenced(each)]


def _individual(definition: Definition) -> dict[str, Any]:
    fields = [{"name": field.name, "type": _type(field.type)} for field in definition.fields]
    return {"type_name": definition.name, "fields": fields}


def _type(field: FieldType) -> dict[str, Any]:
    number = _MESSAGE if field.is_message else _BOUNDED_TEXT if field.text_bound else _IDS[field.base]
    return {
        "type_id": number + _OFFSETS[field.container],
        "capacity": field.size,
        "string_capacity": field.text_bound,
        "nested_type_name": field.base if field.is_message else "",
    }
