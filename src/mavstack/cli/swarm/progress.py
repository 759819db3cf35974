"""How far a swarm is, as one line."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mavstack.cli.common.text import duration_text

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.vehicle import Vehicle
    from mavstack.vehicle.swarm import Swarm


def progress_text(title: str, swarm: Swarm) -> str:
    """Return the part of the course that is flown, the time left, and the smallest separation.

    Args:
        title: What the swarm does.
        swarm: The swarm.
    """
    elapsed, duration = swarm.progress
    parts = []
    if duration == 0.0:
        parts.append("the plan is made")  # a call checks all ways before a vehicle moves
    elif math.isfinite(duration):
        parts.append(f"{min(100 * elapsed / duration, 100):.0f} %")
        if elapsed < duration:
            parts.append(f"{duration_text(duration - elapsed)} left")
    if math.isfinite(swarm.smallest_separation):
        parts.append(f"smallest separation {swarm.smallest_separation:.1f} m")
    return f"{title}: {', '.join(parts)}"


def heights_text(title: str, vehicles: Iterable[Vehicle]) -> str:
    """Return the smallest and the largest height of vehicles above their homes.

    Args:
        title: What the vehicles do.
        vehicles: The vehicles.
    """
    positions = [each.position for each in vehicles]
    known = [each.relative_altitude for each in positions if each is not None]
    heights = [each for each in known if each is not None]
    if not heights:
        return f"{title}: no positions"
    return f"{title}: {min(heights):.1f} to {max(heights):.1f} m high"
