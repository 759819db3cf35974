"""`mav mission show`: plans as tables with a map, or as one JSON object.

The numbers of the items are those of the vehicle or of the file format: they begin at 1 where home is item 0.
The distance of an item is measured from the place before it. Jumps are not followed, so a length is that of
one pass.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

from mavstack.cli.common.connection import run_on_vehicle
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.common.wrapping import UNLIMITED, table_that_fits, terminal_columns
from mavstack.cli.mission.files import read
from mavstack.cli.mission.sketch import flown_path, sketch
from mavstack.cli.mission.text import altitude_text, length_text, number, params_text, place_text
from mavstack.cli.mission.transfer import download_plans
from mavstack.files.plans import check, fence_areas, plan_json
from mavstack.files.plans.model import CMD, PLAN_NAMES
from mavstack.geodesy import distance

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.files.plans import PlanFile
    from mavstack.services.mission import MissionItem
    from mavstack.vehicle import Vehicle

_HEAD = ("#", "command", "place", "altitude", "distance", "params")
_RIGHT = frozenset({0, 4})


def show(arguments: Namespace) -> int:
    """Run `mav mission show`."""
    plan_types = arguments.plan_types or tuple(PLAN_NAMES)
    if arguments.file is not None:
        name, plan = read(arguments.file)
        _print(name, plan.only(plan_types), arguments)
        return 0

    async def work(vehicle: Vehicle) -> int:
        chosen = tuple(dict.fromkeys(plan_types))
        plan = await download_plans(vehicle, chosen, strict=bool(arguments.plan_types))
        _print(f"vehicle {vehicle.system}", plan, arguments)
        return 0

    return run_on_vehicle(arguments, work)


def _print(name: str, plan: PlanFile, arguments: Namespace) -> None:
    if arguments.json:
        echo_json(_json(plan))
        return
    echo(f"{name}: {summary(plan)}")
    for lines in (_mission_lines(plan), _fence_lines(plan), _rally_lines(plan)):
        if lines:
            echo("", *lines)
    drawn = sketch(plan) if arguments.map else []
    if drawn:
        echo("", *drawn)
    problems = [*plan.problems, *map(str, check(plan))]
    if problems or plan.notes:
        echo("")
    for text in problems:
        echo(f"problem: {text}")
    for text in plan.notes:
        echo(f"note: {text}")


def summary(plan: PlanFile) -> str:
    """Return the size of each plan in one line."""
    parts = []
    if len(plan.mission):
        parts.append(f"a mission of {_count(len(plan.mission), 'item')}, {length_text(length(plan))}")
    if len(plan.fence):
        areas = fence_areas(plan.fence.items)
        parts.append(f"a fence of {_count(len(areas.polygons) + len(areas.circles), 'area')}")
    if len(plan.rally):
        parts.append(_count(len(plan.rally), "rally point"))
    return "; ".join(parts) or "no plans"


def length(plan: PlanFile) -> float:
    """Return the length of the path of a mission in metres, without its jumps."""
    return sum(distance(*start, *end) for (_, start), (_, end) in pairwise(flown_path(plan)))


def _json(plan: PlanFile) -> dict[str, Any]:
    plans = plan_json(plan)
    legs = _legs(plan)
    for seq, item in enumerate(plans["mission"]):
        leg = legs.get(seq + plan.first)
        item["distance_m"] = None if leg is None else round(leg, 2)
    problems = [*plan.problems, *map(str, check(plan))]
    return {**plans, "length_m": round(length(plan), 2), "problems": problems, "notes": list(plan.notes)}


def _legs(plan: PlanFile) -> dict[int, float]:
    """Return the distance of each item with a place from the place before it, in metres."""
    return {
        number: distance(*start, *end)
        for (_, start), (number, end) in pairwise(flown_path(plan))
        if number is not None
    }


def _mission_lines(plan: PlanFile) -> list[str]:
    if not len(plan.mission):
        return []
    legs = _legs(plan)
    rows: list[tuple[str, ...]] = [_HEAD]
    if plan.home is not None:
        home = plan.home
        place = f"{home.latitude:.7f} {home.longitude:.7f}"
        rows.append(("0", "home", place, f"{number(home.altitude)} m above sea", "", ""))
    for index, item in enumerate(plan.mission.items, plan.first):
        leg = length_text(legs[index]) if index in legs else ""
        rows.append(_row(str(index), item, leg, plan.first))
    return table_that_fits(rows, terminal_columns(UNLIMITED), right=_RIGHT)


def _row(index: str, item: MissionItem, leg: str, first: int) -> tuple[str, ...]:
    stop = "" if item.autocontinue else "stops here"
    params = ", ".join(filter(None, (params_text(item, first), stop)))
    return index, item.name, place_text(item), altitude_text(item), leg, params


def _fence_lines(plan: PlanFile) -> list[str]:
    areas = fence_areas(plan.fence.items)
    lines = []
    for polygon in areas.polygons:
        side = "inside" if polygon.inclusion else "outside"
        corners = [f"  {latitude:.7f} {longitude:.7f}" for latitude, longitude in polygon.vertices]
        group = f", group {number(polygon.group)}" if polygon.group else ""
        lines += [f"stay {side} the polygon of {len(corners)} vertices{group}", *corners]
    for circle in areas.circles:
        side = "inside" if circle.inclusion else "outside"
        place = f"{circle.center[0]:.7f} {circle.center[1]:.7f}"
        lines.append(f"stay {side} the circle of {number(circle.radius)} m around {place}")
    for point in areas.return_points:
        place = f"{point.place[0]:.7f} {point.place[1]:.7f}"
        lines.append(f"return to {place}, {number(point.altitude)} m")
    return lines


def _rally_lines(plan: PlanFile) -> list[str]:
    rows = [
        (
            f"rally point {index}",
            place_text(item),
            altitude_text(item) if item.command == CMD.NAV_RALLY_POINT else "",
        )
        for index, item in enumerate(plan.rally.items)
    ]
    return align_columns(rows) if rows else []


def _count(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"
