"""One definition from those of several files: an enum has the entries of all files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import DialectError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from mavstack.dialects.model import DialectDefinition, EnumDefinition, EnumEntry


def merge_definitions(definitions: Sequence[DialectDefinition]) -> DialectDefinition:
    """Return the last definition with the messages and enums of all definitions."""
    messages = [message for definition in definitions for message in definition.messages]
    enums = tuple(merge_enums(definitions).values())
    return definitions[-1]._replace(messages=tuple(sorted(messages, key=lambda item: item.id)), enums=enums)


def merge_enums(definitions: Iterable[DialectDefinition]) -> dict[str, EnumDefinition]:
    """Return the merged enums of several files by name, with entries in the order of the files."""
    merged: dict[str, EnumDefinition] = {}
    for definition in definitions:
        for enum in definition.enums:
            known = merged.get(enum.name)
            merged[enum.name] = (
                enum if known is None else merge_enum(known, enum, definition.path or definition.name)
            )
    return merged


def merge_enum(known: EnumDefinition, more: EnumDefinition, path: str) -> EnumDefinition:
    """Return an enum with the entries that another file adds."""
    highest = max((entry.value for entry in known.entries), default=0)
    added = tuple(_new_entries(known, renumbered(more, highest), path))
    return known._replace(entries=known.entries + added, bitmask=known.bitmask or more.bitmask)


def _new_entries(known: EnumDefinition, more: EnumDefinition, path: str) -> Iterator[EnumEntry]:
    by_name = {entry.name: entry for entry in known.entries}
    by_value = {entry.value: entry for entry in known.entries}
    for entry in more.entries:
        existing = by_name.get(entry.name)
        if existing is not None and existing.value == entry.value:
            continue
        if existing is not None:
            problem = (
                f"{entry.name} of enum {more.name} is {existing.value} in an included file "
                f"and {entry.value} here"
            )
            raise DialectError(problem, path, entry.line or None)
        if entry.value in by_value:
            other = by_value[entry.value].name
            raise DialectError(
                f"enum {more.name} has the value {entry.value} twice: {other} and {entry.name}",
                path,
                entry.line or None,
            )
        yield entry


def renumbered(enum: EnumDefinition, highest: int) -> EnumDefinition:
    """Return an enum whose entries without a value are numbered after `highest`, that of included files."""
    if not any(entry.automatic and entry.value <= highest for entry in enum.entries):
        return enum
    entries = []
    for entry in enum.entries:
        renumber = entry.automatic and entry.value <= highest
        entries.append(entry._replace(value=highest + 1) if renumber else entry)
        highest = max(highest, entries[-1].value)
    return enum._replace(entries=tuple(entries))
