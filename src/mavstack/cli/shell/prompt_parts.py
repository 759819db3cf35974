"""The parts of the prompt: `1 GUIDED armed> `, or `vehicle 1, 2?> ` before one of several is selected."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.selection import systems_text

if TYPE_CHECKING:
    from mavstack.cli.shell.session import Session


def prompt_parts(session: Session) -> list[tuple[str, str]]:
    """Return the parts of the prompt as pairs of style and text."""
    vehicle = session.selected
    if vehicle is None:
        heard = systems_text(session.connection.vehicles)
        return [("silent", f"vehicle {heard}?" if heard else "no vehicle"), ("end", "> ")]
    parts = [("system", str(vehicle.system))]
    if not vehicle.alive:
        parts.append(("silent", " silent"))
    else:
        parts.append(("mode", f" {vehicle.mode or '?'}"))
        if vehicle.armed:
            parts.append(("armed", " armed"))
    return [*parts, ("end", "> ")]
