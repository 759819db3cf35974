"""A map of a plan in characters: the path in braille dots, its items by number, the fence around it."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from mavstack.cli.common.character_map import MapObject, draw_map
from mavstack.cli.mission.text import flies_to_position
from mavstack.files.plans import fence_areas
from mavstack.files.plans.model import CMD

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.cli.common.character_map import Cell, CharacterMap, Place
    from mavstack.files.plans import PlanFile

COLUMNS = 64
ROWS = 18
#: Points on each leg of the path: enough for a continuous line.
_POINTS_PER_LEG = 48
#: Points on each side of the fence: few, for a dotted line.
_POINTS_PER_SIDE = 3
_MAX_LEGS = 2000
_MAX_NUMBERS = 25


def sketch(plan: PlanFile) -> list[str]:
    """Return the lines of the map; none if the plan has fewer than two places."""
    objects = _map_objects(plan)
    if len({place for each in objects for place in each.track}) < 2:
        return []
    drawn = draw_map(objects, COLUMNS, ROWS)
    lines = [_line(row) for row in drawn.rows]
    while lines and not lines[0]:
        del lines[0]
    while lines and not lines[-1]:
        del lines[-1]
    return [*lines, _scale(drawn)]


def _map_objects(plan: PlanFile) -> list[MapObject]:
    path = flown_path(plan)
    areas = fence_areas(plan.fence.items)
    objects = [
        MapObject("", "fence", _interpolated([*polygon.vertices, polygon.vertices[0]], _POINTS_PER_SIDE))
        for polygon in areas.polygons
        if all(map(_is_place, polygon.vertices))
    ]
    places = [place for _, place in path][:_MAX_LEGS]
    steps = max(_POINTS_PER_LEG // (1 + len(places) // 50), 4)
    objects.append(MapObject("", "path", _interpolated(places, steps)))
    if plan.home is not None:
        home = (plan.home.latitude, plan.home.longitude)
        objects.append(MapObject("H", "home", [home], home))
    objects += [MapObject("R", "rally", [place], place) for place in _rally(plan)]
    homes = [place for number, place in path if number is None]
    marks = _legible([(number, place) for number, place in path if number is not None and place not in homes])
    objects += [MapObject(str(number), "item", [], place) for number, place in marks]
    return objects


def _legible(marks: list[tuple[int, Place]]) -> list[tuple[int, Place]]:
    """Return a legible selection of the numbers: the first, the last, and round ones between."""
    step = next(step for step in (1, 5, 10, 50, 100, 500, 1000, 5000) if len(marks) <= step * _MAX_NUMBERS)
    ends = {marks[0][0], marks[-1][0]} if marks else set()
    return [mark for mark in marks if mark[0] % step == 0 or mark[0] in ends]


def flown_path(plan: PlanFile) -> list[tuple[int | None, Place]]:
    """Return the places of a mission in the order of flight, with the numbers of the items; home has none."""
    home = None if plan.home is None else (plan.home.latitude, plan.home.longitude)
    path: list[tuple[int | None, Place]] = [] if home is None else [(None, home)]
    for number, item in enumerate(plan.mission.items, plan.first):
        place = (item.param5, item.param6)
        if flies_to_position(item) and _is_place(place):
            path.append((number, place))
        elif item.command == CMD.NAV_RETURN_TO_LAUNCH and home is not None:
            path.append((number, home))
    return path


def _rally(plan: PlanFile) -> list[Place]:
    places = [(item.param5, item.param6) for item in plan.rally.items]
    return [place for place in places if _is_place(place)]


def _is_place(place: Place) -> bool:
    return abs(place[0]) <= 90.0 and abs(place[1]) <= 180.0


def _interpolated(places: Sequence[Place], steps: int) -> list[Place]:
    """Return the path with intermediate points, so that it looks like a line."""
    points = [
        (north + (to_north - north) * step / steps, east + (to_east - east) * step / steps)
        for (north, east), (to_north, to_east) in itertools.pairwise(places)
        for step in range(steps)
    ]
    return [*points, *places[-1:]]


def _line(row: Sequence[Cell]) -> str:
    """Return the characters of a row; a number of two digits covers two cells."""
    text = ""
    for column, cell in enumerate(row):
        if len(text) == column:
            text += cell.symbol
    return text.rstrip()


def _scale(drawn: CharacterMap) -> str:
    return f"├{'─' * max(drawn.bar - 2, 0)}┤ {drawn.bar_metres} m, north is up"
