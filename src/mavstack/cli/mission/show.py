"""`mav mission show`: plans as tables for people, a sketch of them, or one object for programs.

The numbers are those that the vehicle, or the format of the file, calls the items by: from 1 where the home
is item 0. A distance is from the place before; jumps are not followed, so a length is that of one round.
"""

from __future__ import annotations

import json
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from mavstack.cli.common.connection import run_on_vehicle
from mavstack.cli.mission.files import read
from mavstack.cli.mission.sketch import flown, sketch
from mavstack.cli.mission.text import altitude_text, length_text, number, params_text, place_text
from mavstack.cli.mission.transfer import fetch
from mavstack.files.plans import areas_of, check, plan_json
from mavstack.files.plans.model import CMD, KINDS
from mavstack.vehicle.geography import distance

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Sequence

    from mavstack.files.plans import PlanFile
    from mavstack.services.mission import MissionItem
    from mavstack.vehicle import Vehicle

_HEAD = ("#", "command", "place", "altitude", "distance", "params")
_RIGHT = frozenset({0, 4})


def show(arguments: Namespace) -> int:
    """`mav mission show`."""
    kinds = arguments.kinds or tuple(KINDS)
    if arguments.file is not None:
        name, plan = read(arguments.file)
        _print(name, plan.only(kinds), arguments)
        return 0

    async def work(vehicle: Vehicle) -> int:
        plan = await fetch(vehicle, tuple(dict.fromkeys(kinds)), strict=bool(arguments.kinds))
        _print(f"system {vehicle.system}", plan, arguments)
        return 0

    return run_on_vehicle(arguments, work)


def _print(name: str, plan: PlanFile, arguments: Namespace) -> None:
    if arguments.json:
        print(json.dumps(_json(plan), allow_nan=False))
        return
    print(f"{name}: {summary(plan)}")
    for lines in (_mission_lines(plan), _fence_lines(plan), _rally_lines(plan)):
        if lines:
            print("", *lines, sep="\n")
    drawn = sketch(plan) if arguments.map else []
    if drawn:
        print("", *drawn, sep="\n")
    wrong = [*plan.problems, *map(str, check(plan))]
    if wrong or plan.notes:
        print()
    for text in wrong:
        print(f"wrong: {text}")
    for text in plan.notes:
        print(f"note: {text}")


def summary(plan: PlanFile) -> str:
    """All of it in one line."""
    parts = []
    if len(plan.mission):
        parts.append(f"a mission of {_count(len(plan.mission), 'item')}, {length_text(length(plan))}")
    if len(plan.fence):
        areas = areas_of(plan.fence.items)
        parts.append(f"a fence of {_count(len(areas.polygons) + len(areas.circles), 'area')}")
    if len(plan.rally):
        parts.append(_count(len(plan.rally), "rally point"))
    return "; ".join(parts) or "nothing"


def length(plan: PlanFile) -> float:
    """How many metres the path of a mission is long, its jumps not followed."""
    return sum(distance(*start, *end) for (_, start), (_, end) in pairwise(flown(plan)))


def _json(plan: PlanFile) -> dict[str, Any]:
    whole = plan_json(plan)
    legs = _legs(plan)
    for seq, item in enumerate(whole["mission"]):
        leg = legs.get(seq + plan.first)
        item["distance_m"] = None if leg is None else round(leg, 2)
    problems = [*plan.problems, *map(str, check(plan))]
    return {**whole, "length_m": round(length(plan), 2), "problems": problems, "notes": list(plan.notes)}


def _legs(plan: PlanFile) -> dict[int, float]:
    """How far each item that goes somewhere is from the place before."""
    return {
        number: distance(*start, *end)
        for (_, start), (number, end) in pairwise(flown(plan))
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
    return table(rows)


def _row(index: str, item: MissionItem, leg: str, first: int) -> tuple[str, ...]:
    stops = "" if item.autocontinue else "stops here"
    words = ", ".join(filter(None, (params_text(item, first), stops)))
    return index, item.name, place_text(item), altitude_text(item), leg, words


def _fence_lines(plan: PlanFile) -> list[str]:
    areas = areas_of(plan.fence.items)
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
    return table(rows, right=frozenset())


def table(rows: Sequence[Sequence[str]], right: frozenset[int] = _RIGHT) -> list[str]:
    """Rows in columns as wide as they must be."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.rjust(width) if column in right else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def _count(number_of: int, what: str) -> str:
    return f"{number_of} {what}{'' if number_of == 1 else 's'}"
