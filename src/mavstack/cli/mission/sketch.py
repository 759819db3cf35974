"""A sketch of a plan in characters: the path in braille dots, its items by number, the fence around it."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from mavstack.cli.common.character_map import MapObject, draw_map
from mavstack.cli.mission.text import goes_there
from mavstack.files.plans import areas_of
from mavstack.files.plans.model import CMD

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.cli.common.character_map import Cell, Map, Place
    from mavstack.files.plans import PlanFile

COLUMNS = 64
ROWS = 18
#: A leg of the path is drawn through so many points.
_DENSE = 48
#: And a side of the fence through so many, which leaves it dotted.
_SPARSE = 3
_MOST_LEGS = 2000
_MOST_NUMBERS = 25


def sketch(plan: PlanFile) -> list[str]:
    """The lines of a sketch; none if there is nothing to see."""
    things = _things(plan)
    if len({place for thing in things for place in thing.track}) < 2:
        return []
    drawn = draw_map(things, COLUMNS, ROWS)
    lines = [_line(row) for row in drawn.rows]
    while lines and not lines[0]:
        del lines[0]
    while lines and not lines[-1]:
        del lines[-1]
    return [*lines, _scale(drawn)]


def _things(plan: PlanFile) -> list[MapObject]:
    path = flown(plan)
    areas = areas_of(plan.fence.items)
    things = [
        MapObject("", "fence", _dense([*polygon.vertices, polygon.vertices[0]], _SPARSE))
        for polygon in areas.polygons
        if all(map(_is_place, polygon.vertices))
    ]
    places = [place for _, place in path][:_MOST_LEGS]
    steps = max(_DENSE // (1 + len(places) // 50), 4)
    things.append(MapObject("", "path", _dense(places, steps)))
    if plan.home is not None:
        home = (plan.home.latitude, plan.home.longitude)
        things.append(MapObject("H", "home", [home], home))
    things += [MapObject("R", "rally", [place], place) for place in _rally(plan)]
    homes = [place for number, place in path if number is None]
    marks = _legible([(number, place) for number, place in path if number is not None and place not in homes])
    things += [MapObject(str(number), "item", [], place) for number, place in marks]
    return things


def _legible(marks: list[tuple[int, Place]]) -> list[tuple[int, Place]]:
    """So many of the numbers that they can be read: the first, the last, and round ones between."""
    step = next(step for step in (1, 5, 10, 50, 100, 500, 1000, 5000) if len(marks) <= step * _MOST_NUMBERS)
    ends = {marks[0][0], marks[-1][0]} if marks else set()
    return [mark for mark in marks if mark[0] % step == 0 or mark[0] in ends]


def flown(plan: PlanFile) -> list[tuple[int | None, Place]]:
    """The places that a mission goes to in its order, with the numbers of the items; home has none."""
    home = None if plan.home is None else (plan.home.latitude, plan.home.longitude)
    path: list[tuple[int | None, Place]] = [] if home is None else [(None, home)]
    for number, item in enumerate(plan.mission.items, plan.first):
        place = (item.param5, item.param6)
        if goes_there(item) and _is_place(place):
            path.append((number, place))
        elif item.command == CMD.NAV_RETURN_TO_LAUNCH and home is not None:
            path.append((number, home))
    return path


def _rally(plan: PlanFile) -> list[Place]:
    places = [(item.param5, item.param6) for item in plan.rally.items]
    return [place for place in places if _is_place(place)]


def _is_place(place: Place) -> bool:
    return abs(place[0]) <= 90.0 and abs(place[1]) <= 180.0


def _dense(places: Sequence[Place], steps: int) -> list[Place]:
    """The path with points between, so that it looks like a line."""
    dense = [
        (north + (to_north - north) * step / steps, east + (to_east - east) * step / steps)
        for (north, east), (to_north, to_east) in itertools.pairwise(places)
        for step in range(steps)
    ]
    return [*dense, *places[-1:]]


def _line(row: Sequence[Cell]) -> str:
    """The characters of a row; a number of two digits takes the place of two."""
    text = ""
    for column, cell in enumerate(row):
        if len(text) == column:
            text += cell.sign
    return text.rstrip()


def _scale(drawn: Map) -> str:
    return f"├{'─' * max(drawn.bar - 2, 0)}┤ {drawn.bar_metres} m, north is up"
