"""The time of `mav gen lua` beside mavgen.

mavgen's Lua has no parser of a byte stream: it decodes the `mavlink_message_t` that ArduPilot hands to
scripts. So only the generation is compared. mavgen writes into a folder called `modules`, or nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .codegen_generation import generation

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .measure import Row
    from .rows import Bench


def rows(bench: Bench) -> Iterator[Row]:
    """Yield the row of the generator."""
    yield generation("Lua", "lua", "Lua", bench)
