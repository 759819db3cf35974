"""The table of all fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.codegen.templates import string_literal

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen.library import Library


def field_table(library: Library) -> list[str]:
    """Return the lines of a dictionary from message ids to fields."""
    return list(_rows(library))


def _rows(library: Library) -> Iterator[str]:
    for message in library.messages:
        yield f"{message.id}: ("
        for item in message.fields:
            place, units = f"{item.array_length}, {item.offset}", string_literal(item.units)
            yield f'    Field("{item.name}", "{item.type}", {place}, {units}, "{item.enum}"),'
        yield "),"
