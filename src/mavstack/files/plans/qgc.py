"""QGroundControl's JSON: `.plan`, and the `.mission`, `.fence` and `.rally` files of its older versions.

    {"fileType": "Plan", "version": 1, "groundStation": …,
     "mission": {"version": 2, "plannedHomePosition": [lat, lon, alt], "items": […], "cruiseSpeed": …, …},
     "geoFence": {"version": 2, "polygons": […], "circles": […], "breachReturn": [lat, lon, alt]},
     "rallyPoints": {"version": 2, "points": [[lat, lon, alt], …]}}

A file of the older kind is one of the three inner objects, with a fileType of its own or (missions of version
1) none. Parts may be missing, and Mission Planner writes no fileType: the parts that exist are read. In
version 1 a fence was one polygon to stay in. QGC ignores such a fence and one without a version, here both
are read.

Altitudes of rally points and of the return point are relative to home. The format holds only the shapes of a
fence and the positions of rally points; the other params of their items are reported as lost when written.
"""

from __future__ import annotations

import json
from dataclasses import replace
from math import isfinite, isnan
from typing import TYPE_CHECKING, Any, Final

from mavstack.dialects import common
from mavstack.files.plans.fence import Circle, FenceAreas, Polygon, ReturnPoint, fence_areas, fence_items
from mavstack.files.plans.json_tree import JsonValue, as_json
from mavstack.files.plans.model import CMD, FRAME, Home, PlanFile, Settings, item_of
from mavstack.files.plans.parsing import bounded
from mavstack.files.plans.qgc_items import mission_json, read_items

if TYPE_CHECKING:
    from mavstack.files.plans.fence import Point
    from mavstack.files.plans.parsing import Report
    from mavstack.services.mission import MissionItem

#: The settings that QGC writes for an unknown vehicle.
_DEFAULTS: Final = Settings(
    int(common.MavAutopilot.GENERIC), int(common.MavType.QUADROTOR), cruise_speed=15.0, hover_speed=5.0
)
_GROUND_STATION: Final = "Mavstack"


def recognise(text: str) -> bool:
    """Return whether the text may be a JSON file of QGC."""
    return text.lstrip().startswith("{")


def parse(text: str, name: str = "") -> PlanFile:
    """Read the text of a file."""
    root = JsonValue.parse(text, name)
    kind = root.find("fileType")
    kind_name = kind.text().lower() if kind is not None else ""
    mission, fence, rally = (root.find(key) for key in ("mission", "geoFence", "rallyPoints"))
    if kind_name in ("mission", "geofence", "rallypoints"):
        mission = root if kind_name == "mission" else None
        fence = root if kind_name == "geofence" else None
        rally = root if kind_name == "rallypoints" else None
    elif not (mission or fence or rally):
        if root.find("items") is None:
            raise root.wrong("it has none of mission, geoFence and rallyPoints, so it is not a plan file")
        mission = root
    else:
        _version(root, (1,))
    problems: list[str] = []
    notes: list[str] = []
    whole = PlanFile() if mission is None else _read_mission(mission, problems, notes)
    in_fence = [] if fence is None else bounded(fence_items(_read_fence(fence, problems)), name)
    in_rally = [] if rally is None else bounded(_read_rally(rally), name)
    read = PlanFile.of(whole.mission.items, in_fence, in_rally, whole.home)
    return replace(read, settings=whole.settings, problems=tuple(problems), notes=tuple(notes))


def write(plan: PlanFile, report: Report) -> str:
    """Write plans as the text of a `.plan`; `report` collects the losses."""
    settings = _filled(plan.settings)
    home = plan.home or _assumed_home(plan, report)
    mission = {
        "cruiseSpeed": as_json(settings.cruise_speed or 0.0),
        "firmwareType": settings.firmware,
        "globalPlanAltitudeMode": 0,
        "hoverSpeed": as_json(settings.hover_speed or 0.0),
        "items": mission_json(plan.mission.items, report),
        "plannedHomePosition": [as_json(value) for value in (home.latitude, home.longitude, home.altitude)],
        "vehicleType": settings.vehicle_type,
        "version": 2,
    }
    whole = {
        "fileType": "Plan",
        "geoFence": _fence_json(plan, report),
        "groundStation": _GROUND_STATION,
        "mission": mission,
        "rallyPoints": {"points": _rally_json(plan, report), "version": 2},
        "version": 1,
    }
    return json.dumps(whole, indent=4, allow_nan=False) + "\n"


def _version(tree: JsonValue, known: tuple[int, ...]) -> int:
    """Return the version of a part; older files hold version 1 as a string, or leave it out."""
    found = tree.find("version")
    if found is None or found.value in ("1.0", "1"):
        return known[0]
    version = found.integer(0, 10**9)
    if version not in known:
        raise found.wrong(f"version {version} is not supported, only {' and '.join(map(str, known))}")
    return version


def _read_mission(tree: JsonValue, problems: list[str], notes: list[str]) -> PlanFile:
    version = _version(tree, (1, 2))
    items = bounded(read_items(tree, version, problems, notes), tree.name)
    home = tree.find("plannedHomePosition")
    if home is not None and isinstance(home.value, dict):
        home = home.find("coordinate")
    settings = Settings(
        _optional_integer(tree, "firmwareType") or _optional_integer(tree, "MAV_AUTOPILOT"),
        _optional_integer(tree, "vehicleType"),
        _optional_number(tree, "cruiseSpeed"),
        _optional_number(tree, "hoverSpeed"),
    )
    read = PlanFile.of(items, home=None if home is None or home.value is None else _home(home))
    return replace(read, settings=settings)


def _home(tree: JsonValue) -> Home | None:
    """Return the home; None for the zeros that QGC writes without one."""
    latitude, longitude, altitude = (element.number() for element in tree.elements(3))
    if not (isfinite(latitude) and isfinite(longitude)):
        raise tree.wrong("the home position is not finite")
    found = Home(latitude, longitude, altitude if isfinite(altitude) else 0.0)
    return found if found != Home(0.0, 0.0) else None


def _optional_integer(tree: JsonValue, key: str) -> int | None:
    found = tree.find(key)
    return None if found is None else found.integer(0, 255)


def _optional_number(tree: JsonValue, key: str) -> float | None:
    found = tree.find(key)
    value = None if found is None else found.number()
    return None if value is None or not isfinite(value) else value


def _read_fence(tree: JsonValue, problems: list[str]) -> FenceAreas:
    areas = FenceAreas()
    polygon = tree.find("polygon") if _version(tree, (1, 2)) == 1 else None
    if polygon is not None and polygon.elements():
        areas.polygons.append(Polygon(inclusion=True, vertices=_vertices(polygon)))
    polygons, circles = tree.find("polygons"), tree.find("circles")
    areas.polygons += [_polygon(each, problems) for each in (polygons.elements() if polygons else ())]
    areas.circles += [_circle(each) for each in (circles.elements() if circles else ())]
    if tree.find("version") is None and (areas.polygons or areas.circles):
        problems.append(f"{tree.path}: has no version; QGroundControl ignores such a fence")
    breach = tree.find("breachReturn")
    if breach is not None and breach.elements():
        place = [element.finite() for element in breach.elements()]
        if len(place) not in (2, 3):
            raise breach.wrong("is not a latitude, a longitude and an altitude")
        areas.return_points.append(ReturnPoint((place[0], place[1]), place[2] if place[2:] else 0.0))
    return areas


def _polygon(tree: JsonValue, problems: list[str]) -> Polygon:
    for key in ("altitudeMin", "altitudeMax", "minAltitude", "maxAltitude"):
        limit = tree.find(key)
        if limit is not None and limit.value is not None:
            problems.append(f"{limit.path}: altitude limits of a polygon are not supported")
    return Polygon(tree.get("inclusion").flag(), _vertices(tree.get("polygon")))


def _vertices(tree: JsonValue) -> tuple[Point, ...]:
    vertices = tuple(_point(vertex) for vertex in tree.elements())
    if len(vertices) < 3:
        raise tree.wrong(f"a polygon needs at least 3 vertices, got {len(vertices)}")
    return vertices


def _circle(tree: JsonValue) -> Circle:
    circle = tree.get("circle")
    return Circle(tree.get("inclusion").flag(), _point(circle.get("center")), circle.get("radius").finite())


def _point(tree: JsonValue) -> Point:
    values = [element.finite() for element in tree.elements()[:2]]
    if len(values) != 2:
        raise tree.wrong("is not a latitude and a longitude")
    return values[0], values[1]


def _read_rally(tree: JsonValue) -> list[MissionItem]:
    _version(tree, (1, 2))
    items = []
    for point in tree.get("points").elements():
        latitude, longitude, altitude = (element.number() for element in point.elements(3))
        params = (0.0, 0.0, 0.0, 0.0, latitude, longitude, 0.0 if isnan(altitude) else altitude)
        items.append(item_of(CMD.NAV_RALLY_POINT, params, FRAME.GLOBAL_RELATIVE_ALT, autocontinue=False))
    return items


def _filled(given: Settings) -> Settings:
    """Return the settings with QGC's defaults for the missing ones."""
    names = ("firmware", "vehicle_type", "cruise_speed", "hover_speed")
    missing = {name: getattr(_DEFAULTS, name) for name in names if getattr(given, name) is None}
    return replace(given, **missing)


def _assumed_home(plan: PlanFile, report: Report) -> Home:
    """Return the first position of the mission, for a plan without a home."""
    places = ((item.param5, item.param6) for item in plan.mission.items if item.frame != FRAME.MISSION)
    place = next((place for place in places if any(place) and all(map(isfinite, place))), (0.0, 0.0))
    if len(plan.mission):
        report.notes.append(
            "the mission has no home, which this format needs: its first position was written"
        )
    return Home(*place)


def _fence_json(plan: PlanFile, report: Report) -> dict[str, Any]:
    areas = fence_areas(plan.fence.items)
    for index, problem in areas.leftovers:
        report.losses.append(f"fence item {index}: {problem}")
    for index, item in enumerate(plan.fence.items):
        if item.param2:
            report.losses.append(f"the inclusion group of fence item {index}")
    fence: dict[str, Any] = {
        "circles": [
            {
                "circle": {"center": _place_json(circle.center), "radius": as_json(circle.radius)},
                "inclusion": circle.inclusion,
                "version": 1,
            }
            for circle in areas.circles
        ],
        "polygons": [
            {
                "inclusion": polygon.inclusion,
                "polygon": [_place_json(vertex) for vertex in polygon.vertices],
                "version": 1,
            }
            for polygon in areas.polygons
        ],
        "version": 2,
    }
    for point in areas.return_points[:1]:
        fence["breachReturn"] = [*_place_json(point.place), as_json(point.altitude)]
        if point.frame != FRAME.GLOBAL_RELATIVE_ALT and point.altitude:
            report.losses.append("that the altitude of the return point is not relative to home")
    if len(areas.return_points) > 1:
        report.losses.append("return points but the first")
    return fence


def _rally_json(plan: PlanFile, report: Report) -> list[list[Any]]:
    points = []
    for index, item in enumerate(plan.rally.items):
        if item.command != CMD.NAV_RALLY_POINT:
            report.losses.append(f"rally point {index}, a {item.name}")
            continue
        if item.frame != FRAME.GLOBAL_RELATIVE_ALT:
            report.losses.append(f"that the altitude of rally point {index} is not relative to home")
        if any((item.param1, item.param2, item.param3, item.param4)):
            report.losses.append(f"params 1 to 4 of rally point {index}")
        points.append([*_place_json((item.param5, item.param6)), as_json(item.param7)])
    return points


def _place_json(place: Point) -> list[Any]:
    return [as_json(value) for value in place]
