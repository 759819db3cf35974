"""Checks before any member of a swarm is moved."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.shows.check import ShowLimits, check_show
from mavstack.vehicle.swarm.fleet import LOWEST_SLOT

if TYPE_CHECKING:
    from mavstack.swarm.arrays import Points
    from mavstack.swarm.shows.show import Show


def check_show_of(show: Show, members: int, limits: ShowLimits) -> None:
    """Refuse a show that these members cannot fly."""
    if len(show.vehicles) != members:
        raise InvalidArgumentError(f"the show has {len(show.vehicles)} vehicles, the swarm has {members}")
    problems = check_show(show, limits).problems
    if problems:
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        raise InvalidArgumentError(f"the show cannot be flown: {problems[0]}{more}")


def check_heights(slots: Points, starts: Points) -> None:
    """Refuse slots near the ground, unless a vehicle is as low: a rover has no other height."""
    lowest = float(slots[:, 2].min())
    if lowest < min(LOWEST_SLOT, float(starts[:, 2].min())):
        raise InvalidArgumentError(
            f"slots must be at least {LOWEST_SLOT:g} m above the leader's home, the lowest one is at "
            f"{lowest:.1f} m: increase the altitude or reduce the spacing"
        )
