"""The table of all fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
            texts = f'"{item.name}", "{item.type}"'
            yield f'    Field({texts}, {item.array_length}, {item.offset}, "{item.units}", "{item.enum}"),'
        yield "),"
