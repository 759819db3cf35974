"""`mav mission search` and `mav swarm search`: a search pattern around a point, as ordinary missions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.options import finite_number
from mavstack.cli.mission.planned import (
    Planned,
    add_plan_options,
    mission_options,
    place,
    run_plan,
    searcher_of,
)
from mavstack.swarm.search.plans import PATTERNS, pattern_tracks, plan_search
from mavstack.swarm.search.surveys import frame_of

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Sequence

    from mavstack.cli.mission.planned import SelectVehicles
    from mavstack.vehicle import Vehicle


def add_search_arguments(action: ArgumentParser) -> None:
    """Declare the options of a search."""
    add = action.add_argument
    add("pattern", choices=tuple(PATTERNS), metavar="PATTERN", help=f"one of {', '.join(PATTERNS)}")
    add("--center", type=place, required=True, metavar="LAT,LON", help="centre of the pattern in degrees")
    numbers = (
        ("--size", 200.0, "side of the square, or the diameter of a sector search (default: 200)"),
        ("--spacing", 20.0, "metres between tracks (default: 20)"),
    )
    for name, default, text in numbers:
        add(name, type=finite_number, default=default, metavar="M", help=text)
    add_plan_options(action)


def search(arguments: Namespace, select: SelectVehicles, *, numbered: bool) -> int:
    """Plan a search.

    Args:
        arguments: The parsed arguments.
        select: Returns the vehicles, the first one for the lowest layer.
        numbered: True: the file of a single vehicle has its number too.
    """

    def make(vehicles: Sequence[Vehicle | None]) -> Planned:
        frame = frame_of([arguments.center])
        bearing = arguments.bearing or 0.0
        tracks = pattern_tracks(arguments.pattern, arguments.size, arguments.spacing, bearing)
        searchers = [searcher_of(arguments, frame, each) for each in vehicles]
        values = {
            "pattern": arguments.pattern,
            "center": arguments.center,
            "size_m": arguments.size,
            "spacing_m": arguments.spacing,
        }
        shares = plan_search(tracks, searchers, frame, mission_options(arguments))
        return Planned(shares, frame, values, searchers)

    return run_plan(arguments, make, select, numbered=numbered)
