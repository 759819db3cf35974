"""The parts of the prompt: `1 GUIDED armed> `."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.cli.shell.session import Session


def prompt_parts(session: Session) -> list[tuple[str, str]]:
    """Return the parts of the prompt as pairs of style and text."""
    vehicle = session.selected
    if vehicle is None:
        return [("silent", "no vehicle"), ("end", "> ")]
    parts = [("system", str(vehicle.system))]
    if not vehicle.alive:
        parts.append(("silent", " silent"))
    else:
        parts.append(("mode", f" {vehicle.mode or '?'}"))
        if vehicle.armed:
            parts.append(("armed", " armed"))
    return [*parts, ("end", "> ")]
