"""The areas of a fence: polygons, circles and a return point, which are items in a plan and shapes in files.

A polygon is a series of vertex items whose param 1 is the number of vertices. Vertices whose number does not
match are not a polygon for any vehicle; they are left over.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.files.plans.model import CMD, FRAME
from mavstack.services.mission import MissionItem

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

Point: TypeAlias = tuple[float, float]

VERTICES: Final[Mapping[int, bool]] = MappingProxyType(
    {CMD.NAV_FENCE_POLYGON_VERTEX_INCLUSION: True, CMD.NAV_FENCE_POLYGON_VERTEX_EXCLUSION: False}
)
CIRCLES: Final[Mapping[int, bool]] = MappingProxyType(
    {CMD.NAV_FENCE_CIRCLE_INCLUSION: True, CMD.NAV_FENCE_CIRCLE_EXCLUSION: False}
)
FENCE_COMMANDS: Final = frozenset({CMD.NAV_FENCE_RETURN_POINT, *VERTICES, *CIRCLES})
MIN_VERTICES: Final = 3


@dataclass(frozen=True, slots=True)
class Polygon:
    """A polygon to stay in, or to stay out of; `group` is 0 unless inclusions are combined."""

    inclusion: bool
    vertices: tuple[Point, ...]
    group: float = 0.0


@dataclass(frozen=True, slots=True)
class Circle:
    """A circle to stay in, or to stay out of; `radius` in metres."""

    inclusion: bool
    center: Point
    radius: float
    group: float = 0.0


@dataclass(frozen=True, slots=True)
class ReturnPoint:
    """The point to return to after a breach; `altitude` in metres in `frame`."""

    place: Point
    altitude: float = 0.0
    frame: int = FRAME.GLOBAL_RELATIVE_ALT


@dataclass(slots=True)
class FenceAreas:
    """A whole fence; `leftovers` holds the index and the problem of each item that is no area."""

    polygons: list[Polygon] = field(default_factory=list)
    circles: list[Circle] = field(default_factory=list)
    return_points: list[ReturnPoint] = field(default_factory=list)
    leftovers: list[tuple[int, str]] = field(default_factory=list)


def fence_areas(items: Iterable[MissionItem]) -> FenceAreas:
    """Return the areas of a fence's items."""
    areas, open_items = FenceAreas(), list[tuple[int, MissionItem]]()
    for index, item in enumerate(items):
        if open_items and not _belongs(open_items[0][1], item):
            _leave_over(areas, open_items)
        if item.command in VERTICES:
            open_items.append((index, item))
            if len(open_items) == item.param1 and len(open_items) >= MIN_VERTICES:
                areas.polygons.append(_polygon([vertex for _, vertex in open_items]))
                open_items.clear()
        elif item.command in CIRCLES:
            place = (item.param5, item.param6)
            areas.circles.append(Circle(CIRCLES[item.command], place, item.param1, item.param2))
        elif item.command == CMD.NAV_FENCE_RETURN_POINT:
            point = ReturnPoint((item.param5, item.param6), item.param7, item.frame)
            areas.return_points.append(point)
        else:
            areas.leftovers.append((index, f"{item.name} is not a fence item"))
    _leave_over(areas, open_items)
    return areas


def fence_items(areas: FenceAreas) -> list[MissionItem]:
    """Return the items of a fence in QGroundControl's order: polygons, circles, return point."""
    items: list[MissionItem] = []
    for polygon in areas.polygons:
        items += polygon_items(polygon)
    for circle in areas.circles:
        items.append(circle_item(circle))
    return items + [return_item(point) for point in areas.return_points]


def polygon_items(polygon: Polygon) -> list[MissionItem]:
    """Return the vertex items of a polygon."""
    count = float(len(polygon.vertices))
    inside, outside = CMD.NAV_FENCE_POLYGON_VERTEX_INCLUSION, CMD.NAV_FENCE_POLYGON_VERTEX_EXCLUSION
    command = inside if polygon.inclusion else outside
    return [_fence_item(command, count, polygon.group, vertex) for vertex in polygon.vertices]


def circle_item(circle: Circle) -> MissionItem:
    """Return the item of a circle."""
    command = CMD.NAV_FENCE_CIRCLE_INCLUSION if circle.inclusion else CMD.NAV_FENCE_CIRCLE_EXCLUSION
    return _fence_item(command, circle.radius, circle.group, circle.center)


def return_item(point: ReturnPoint) -> MissionItem:
    """Return the item of a return point."""
    return MissionItem(
        CMD.NAV_FENCE_RETURN_POINT,
        param5=point.place[0],
        param6=point.place[1],
        param7=point.altitude,
        frame=point.frame,
        autocontinue=False,
    )


def _fence_item(command: int, first: float, group: float, place: Point) -> MissionItem:
    return MissionItem(
        command, first, group, param5=place[0], param6=place[1], frame=FRAME.GLOBAL, autocontinue=False
    )


def _belongs(first: MissionItem, item: MissionItem) -> bool:
    return (item.command, item.param1, item.param2) == (first.command, first.param1, first.param2)


def _polygon(vertices: list[MissionItem]) -> Polygon:
    first = vertices[0]
    places = tuple((vertex.param5, vertex.param6) for vertex in vertices)
    return Polygon(VERTICES[first.command], places, first.param2)


def _leave_over(areas: FenceAreas, open_items: list[tuple[int, MissionItem]]) -> None:
    if not open_items:
        return
    index, first = open_items[0]
    wanted = f"{first.param1:g}" if isfinite(first.param1) else "an invalid number"
    count = len(open_items)
    found = "1 vertex" if count == 1 else f"{count} vertices"
    areas.leftovers.append((index, f"{found} in a row, but param 1 says that the polygon has {wanted}"))
    open_items.clear()
