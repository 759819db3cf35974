"""Short names of enum entries: without the words that all entries of the enum share.

They are those of `mavstack.dialects` in Python: `MAV_CMD_NAV_TAKEOFF` of `MAV_CMD` is `NAV_TAKEOFF`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects.names import member_names

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.codegen.library import Library


def entry_names(library: Library, taken: Iterable[str] = ()) -> dict[str, dict[str, str]]:
    """Return the short names of the entries of each enum, by the names of the enum and of the entry.

    Args:
        library: The library.
        taken: Names that no entry may have; such an entry gets a trailing `_`.

    Returns:
        The names of all enums of the library.
    """
    taken = frozenset(taken)
    origins: dict[str, list[str]] = {}
    for file in library.files:
        for enum in file.enums:
            origins.setdefault(enum.name, [entry.name for entry in enum.entries])
    names = {}
    for enum in library.enums:
        origin = origins[enum.name]
        known = frozenset(origin)
        added = [entry.name for entry in enum.entries if entry.name not in known]
        names[enum.name] = member_names(enum.name, origin, added, taken)
    return names
