"""`mav mission survey`: an area or a corridor, covered by tracks, as ordinary missions."""

from __future__ import annotations

import argparse
from math import isfinite
from typing import TYPE_CHECKING

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.options import finite_number
from mavstack.cli.mission.files import read
from mavstack.cli.mission.planned import (
    Planned,
    add_plan_options,
    mission_options,
    place,
    run_plan,
    searcher_of,
)
from mavstack.errors import PlanFileError
from mavstack.files.plans.fence import fence_areas
from mavstack.swarm.search.camera import Camera
from mavstack.swarm.search.surveys import DIVISIONS, Survey, frame_of, plan_area, plan_corridor

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Sequence

    from mavstack.cli.mission.planned import SelectVehicles
    from mavstack.swarm.search.surveys import Place
    from mavstack.vehicle import Vehicle


def add_survey_arguments(action: ArgumentParser) -> None:
    """Declare the options of a survey."""
    add = action.add_argument
    add("corners", nargs="*", type=place, metavar="LAT,LON", help="corners of the area, or of the corridor")
    add(
        "--area",
        metavar="FILE",
        help="plan file with a fence: its inclusion polygon is the area, exclusion polygons are obstacles",
    )
    add("--corridor", type=finite_number, metavar="WIDTH", help="survey a corridor along the corners")
    add(
        "--spacing",
        type=finite_number,
        metavar="M",
        help="metres between tracks (default: the camera's, or 20)",
    )
    add(
        "--camera",
        type=_camera,
        metavar="H,V[,PIXELS]",
        help="angles of view across and along the flight in degrees, and pixels across: takes pictures",
    )
    add(
        "--overlap",
        type=_overlap,
        default=(0.7, 0.75),
        metavar="SIDE,FRONT",
        help="percent of a picture that the next track and the next picture show (default: 70,75)",
    )
    add("--crosshatch", action="store_true", help="cover the area a second time, across")
    add(
        "--turn-radius",
        type=finite_number,
        default=0.0,
        metavar="M",
        help="metres that a wing needs for a turn (default: 0)",
    )
    divisions = "; ".join(f"{name}: {text}" for name, text in DIVISIONS.items())
    add("--division", choices=tuple(DIVISIONS), default="strips", help=f"{divisions} (default: strips)")
    add_plan_options(action)


def survey(arguments: Namespace, select: SelectVehicles) -> int:
    """Run `mav mission survey`.

    Args:
        arguments: The parsed arguments.
        select: Returns the vehicles, the first one for the lowest layer.
    """
    corners, obstacles = _area(arguments)
    options = Survey(
        spacing=arguments.spacing,
        camera=arguments.camera,
        side_overlap=arguments.overlap[0],
        front_overlap=arguments.overlap[1],
        bearing=arguments.bearing,
        crosshatch=arguments.crosshatch,
        turn_radius=arguments.turn_radius,
        division=arguments.division,
        mission=mission_options(arguments),
    )

    def make(vehicles: Sequence[Vehicle | None]) -> Planned:
        frame = frame_of(corners)
        searchers = [searcher_of(arguments, frame, each) for each in vehicles]
        if arguments.corridor is None:
            plan = plan_area(corners, searchers, options, obstacles=obstacles)
        else:
            plan = plan_corridor(corners, arguments.corridor, searchers, options)
        values = {
            "area_m2": round(plan.size, 1),
            "spacing_m": round(plan.spacing, 3),
            "bearing_deg": None if plan.bearing is None else round(plan.bearing % 180.0, 3),
            "trigger_distance_m": round(options.mission_options.trigger_distance, 3),
        }
        return Planned(plan.shares, plan.frame, values, searchers)

    return run_plan(arguments, make, select, numbered=False)


def _area(arguments: Namespace) -> tuple[list[Place], list[list[Place]]]:
    """Return the corners and the obstacles of the arguments."""
    if (arguments.area is None) == (not arguments.corners):
        raise UsageError("give the corners of the area, or --area FILE")
    if arguments.area is None:
        return arguments.corners, []
    name, plan = read(arguments.area)
    polygons = fence_areas(plan.fence.items).polygons
    inside = [each for each in polygons if each.inclusion]
    if len(inside) != 1:
        raise PlanFileError(f"its fence has {len(inside)} inclusion polygons, exactly one is the area", name)
    obstacles = [list(each.vertices) for each in polygons if not each.inclusion]
    return list(inside[0].vertices), obstacles


def _camera(text: str) -> Camera:
    """Parse the angles of view and the pixels of a camera, for argparse."""
    numbers = _numbers(text, 2, 3)
    across, along, *pixels = numbers
    if not (0.0 < across < 180.0 and 0.0 < along < 180.0):
        raise argparse.ArgumentTypeError(
            f"angles of view are more than 0 and less than 180 degrees: {text!r}"
        )
    return Camera(across, along, int(pixels[0]) if pixels else 0)


def _overlap(text: str) -> tuple[float, float]:
    """Parse two percentages, for argparse."""
    side, front = _numbers(text, 2, 2)
    if not (0.0 <= side < 100.0 and 0.0 <= front < 100.0):
        raise argparse.ArgumentTypeError(f"overlaps are at least 0 and less than 100 percent: {text!r}")
    return side / 100.0, front / 100.0


def _numbers(text: str, low: int, high: int) -> list[float]:
    try:
        numbers = [float(each) for each in text.split(",")]
    except ValueError:
        numbers = []
    if not low <= len(numbers) <= high or not all(map(isfinite, numbers)):
        raise argparse.ArgumentTypeError(f"{text!r} is not a list of numbers such as 70,75")
    return numbers
