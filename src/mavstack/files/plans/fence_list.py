"""The older fence files of ArduPilot's ground stations: a latitude and a longitude on each line.

The first line is the return point, the others are the one polygon to stay in, closed by its first vertex.
The return point has no altitude. Mission Planner's polygon files (`.poly`) look the same but have no return
point: their first line is their last one. The format holds no other part of a fence.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from mavstack.errors import PlanFileError
from mavstack.files.plans.fence import (
    MIN_VERTICES,
    FenceAreas,
    Polygon,
    ReturnPoint,
    fence_areas,
    fence_items,
)
from mavstack.files.plans.model import FRAME, PLAN_NAMES, PlanFile
from mavstack.files.plans.parsing import bounded, first_line, is_number, lines_of, number_text

if TYPE_CHECKING:
    from mavstack.files.plans.fence import Point
    from mavstack.files.plans.parsing import Report


def recognise(text: str) -> bool:
    """Return whether the text begins with two numbers."""
    line = first_line(text)
    return line is not None and len(line.words) == 2 and all(map(is_number, line.words))


def parse(text: str, name: str = "") -> PlanFile:
    """Read a text."""
    points: list[Point] = []
    for line in lines_of(text, name):
        if len(line.words) != 2:
            raise line.wrong(f"has {len(line.words)} values instead of a latitude and a longitude")
        points.append((line.number_at(0, "the latitude"), line.number_at(1, "the longitude")))
    notes: list[str] = []
    areas = FenceAreas()
    if len(points) > MIN_VERTICES and points[0] == points[-1] and points.count(points[0]) == 2:
        notes.append("the first line equals the last one: read as a polygon without a return point")
        vertices = points[:-1]
    else:
        areas.return_points += [ReturnPoint(point, 0.0, FRAME.GLOBAL) for point in points[:1]]
        vertices = points[1:]
        if len(vertices) > 1 and vertices[0] == vertices[-1]:
            vertices.pop()
        else:
            notes.append("the polygon is not closed by its first vertex: read as if it were")
    if len(vertices) < MIN_VERTICES:
        raise PlanFileError(f"a fence needs a return point and at least {MIN_VERTICES} vertices", name)
    areas.polygons.append(Polygon(inclusion=True, vertices=tuple(vertices)))
    return replace(PlanFile.of(fence=bounded(fence_items(areas), name)), notes=tuple(notes))


def write(plan: PlanFile, report: Report) -> str:
    """Write a fence as text; `report` collects the losses."""
    areas = fence_areas(plan.fence.items)
    for kind in plan.kinds:
        if kind != plan.fence.type:
            report.losses.append(f"the {PLAN_NAMES[kind]}")
    _report_lost(areas, report)
    polygon = next((polygon for polygon in areas.polygons if polygon.inclusion), None)
    if polygon is None:
        raise PlanFileError("this format holds one polygon to stay in, and the plan has none: use .waypoints")
    place = areas.return_points[0].place if areas.return_points else _middle(polygon.vertices)
    if not areas.return_points:
        report.notes.append(
            "the plan has no return point, which this format needs: the middle of the polygon was written"
        )
    points = (place, *polygon.vertices, polygon.vertices[0])
    return "".join(f"{number_text(latitude)} {number_text(longitude)}\n" for latitude, longitude in points)


def _report_lost(areas: FenceAreas, report: Report) -> None:
    for index, problem in areas.leftovers:
        report.losses.append(f"fence item {index}: {problem}")
    inclusions = [polygon for polygon in areas.polygons if polygon.inclusion]
    lost = {
        "polygons to stay out of": len(areas.polygons) - len(inclusions),
        "polygons to stay in but the first": max(len(inclusions) - 1, 0),
        "circles": len(areas.circles),
        "return points but the first": max(len(areas.return_points) - 1, 0),
        "inclusion groups": sum(bool(polygon.group) for polygon in inclusions[:1]),
    }
    for label, count in lost.items():
        if count:
            report.losses.append(f"{label} ({count}), only one polygon to stay in and a return point")
    if any(point.altitude for point in areas.return_points[:1]):
        report.losses.append("the altitude of the return point")


def _middle(vertices: tuple[Point, ...]) -> Point:
    count = len(vertices)
    return sum(place[0] for place in vertices) / count, sum(place[1] for place in vertices) / count
