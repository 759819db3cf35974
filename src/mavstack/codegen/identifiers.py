"""Identifiers of generated code: enum members without their common words, fields, and no name twice.

The members are those of `mavstack.dialects` in Python: `MAV_CMD_NAV_TAKEOFF` of `MAV_CMD` is `NAV_TAKEOFF`.
"""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING

from mavstack.dialects.names import class_name, member_names

if TYPE_CHECKING:
    from collections.abc import Container, Iterable

    from mavstack.codegen.library import Library


def enum_members(library: Library, taken: Iterable[str] = ()) -> dict[str, dict[str, str]]:
    """Return the member names of all enums, such as `QUADROTOR` for `MAV_TYPE_QUADROTOR`.

    Args:
        library: The library; the file that first defines an enum determines the words that are removed.
        taken: Names that no member may have; such a member gets a trailing `_`.

    Returns:
        Member names by enum name and entry name.
    """
    taken = frozenset(taken)
    origin: dict[str, list[str]] = {}
    for file in library.files:
        for enum in file.enums:
            origin.setdefault(enum.name, [entry.name for entry in enum.entries])
    members = {}
    for enum in library.enums:
        first = origin[enum.name]
        known = frozenset(first)
        added = [entry.name for entry in enum.entries if entry.name not in known]
        members[enum.name] = member_names(enum.name, first, added, taken)
    return members


def distinct(names: Iterable[str], reserved: Container[str] = ()) -> list[str]:
    """Return names of which none is reserved or twice there; such a name gets a trailing `_`."""
    used: set[str] = set()
    result = []
    for name in names:
        free = name
        while free in reserved or free in used:
            free += "_"
        used.add(free)
        result.append(free)
    return result


def type_names(official: Iterable[str], reserved: Container[str] = ()) -> dict[str, str]:
    """Return the class names of messages or enums by their official names."""
    official = list(official)
    return dict(zip(official, distinct(map(class_name, official), reserved), strict=True))


@cache
def pascal_field(name: str) -> str:
    """Return `TimeBootMs` for `time_boot_ms`, `Vcc` for `Vcc`, and `IcaoAddress` for `ICAO_address`."""
    words = [word for word in name.split("_") if word]
    joined = "".join(
        word.capitalize() if word.isupper() else word[:1].upper() + word[1:] for word in words or ["_"]
    )
    return f"_{joined}" if joined[:1].isdigit() else joined


def camel_field(name: str) -> str:
    """Return `timeBootMs` for `time_boot_ms`, `vcc` for `Vcc`, and `icaoAddress` for `ICAO_address`."""
    pascal = pascal_field(name)
    return pascal[:1].lower() + pascal[1:]


def package_part(name: str) -> str:
    """Return the name of a dialect for a package or module: `my_drone` for the file `My-Drone.xml`."""
    plain = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
    return plain if plain[:1].isalpha() else f"dialect_{plain}".rstrip("_")
