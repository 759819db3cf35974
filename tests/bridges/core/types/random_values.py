"""Random values for any interface definition, as flat values."""

from __future__ import annotations

from struct import pack, unpack
from typing import TYPE_CHECKING, Any

from mavstack.bridges.core.types import definition_of
from mavstack.bridges.core.types.model import Container, FieldType

if TYPE_CHECKING:
    from random import Random

BITS = {"int8": 8, "int16": 16, "int32": 32, "int64": 64}
UNSIGNED = {"uint8": 8, "byte": 8, "char": 8, "uint16": 16, "uint32": 32, "uint64": 64}


def random_values(name: str, rng: Random) -> list[Any]:
    """Return random flat values of a message."""
    return [value for field in definition_of(name).fields for value in values_of(field.type, rng)]


def values_of(kind: FieldType, rng: Random) -> list[Any]:
    if kind.container is Container.ONE:
        return random_values(kind.base, rng) if kind.is_message else [scalar(kind.base, rng)]
    if kind.container is Container.ARRAY:
        return [value for _ in range(kind.size) for value in values_of(FieldType(kind.base), rng)]
    count = rng.randrange(min(kind.size or 4, 4) + 1)
    if kind.is_message:
        return [tuple(tuple(random_values(kind.base, rng)) for _ in range(count))]
    found = tuple(scalar(kind.base, rng) for _ in range(count))
    return [bytes(found) if kind.base in ("uint8", "byte", "char") else found]


def scalar(base: str, rng: Random) -> Any:
    if base == "bool":
        return rng.random() < 0.5
    if base == "string":
        return "".join(rng.choices("abcÄ/_ 0", k=rng.randrange(9)))
    if base in UNSIGNED:
        return rng.getrandbits(UNSIGNED[base])
    if base in BITS:
        return rng.getrandbits(BITS[base]) - (1 << BITS[base] - 1)
    value = rng.uniform(-1e6, 1e6)
    return unpack("<f", pack("<f", value))[0] if base == "float32" else value
