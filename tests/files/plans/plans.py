"""Plans for the tests: some written by hand, and any at all."""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING

from hypothesis import strategies as st

from mavstack.files.plans.fence import Circle, FenceAreas, Polygon, ReturnPoint, fence_items
from mavstack.files.plans.model import CMD, FRAME, Home, PlanFile, item_of, params_of, plain_frame
from mavstack.services.mission import MissionItem

if TYPE_CHECKING:
    from mavstack.services.mission import Plan

FLIGHT = """\
{"fileType": "Plan", "version": 1, "groundStation": "QGroundControl",
 "geoFence": {"version": 2,
  "circles": [{"circle": {"center": [47.399, 8.549], "radius": 25.5}, "inclusion": false, "version": 1}],
  "polygons": [{"inclusion": true, "version": 1,
    "polygon": [[47.40, 8.54], [47.40, 8.55], [47.39, 8.55], [47.39, 8.54]]}],
  "breachReturn": [47.3977, 8.5456, 30]},
 "rallyPoints": {"version": 2, "points": [[47.396, 8.544, 25], [47.395, 8.545, 15.5]]},
 "mission": {"version": 2, "firmwareType": 3, "vehicleType": 2, "cruiseSpeed": 15, "hoverSpeed": 5,
  "plannedHomePosition": [47.3977419, 8.5455939, 488], "items": [
   {"type": "SimpleItem", "command": 22, "frame": 3, "autoContinue": true, "doJumpId": 1,
    "params": [0, 0, 0, null, 0, 0, 20]},
   {"type": "SimpleItem", "command": 16, "frame": 3, "autoContinue": true, "doJumpId": 2,
    "params": [3, 0, 0, null, 47.3980, 8.5460, 30]},
   {"type": "SimpleItem", "command": 16, "frame": 0, "autoContinue": false, "doJumpId": 3,
    "params": [0, 0, 0, 90, 47.3985, 8.5450, 520.25]},
   {"type": "SimpleItem", "command": 177, "frame": 2, "autoContinue": true, "doJumpId": 4,
    "params": [2, 3, 0, 0, 0, 0, 0]},
   {"type": "SimpleItem", "command": 20, "frame": 2, "autoContinue": true, "doJumpId": 5,
    "params": [0, 0, 0, 0, 0, 0, 0]}]}}
"""

WAYPOINTS = """\
QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t47.3977419\t8.5455939\t488\t1
1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t20\t1
2\t0\t3\t16\t3\t0\t0\t0\t47.398\t8.546\t30\t1
3\t0\t0\t16\t0\t0\t0\t90\t47.3985\t8.545\t520.25\t0
4\t0\t2\t177\t2\t3\t0\t0\t0\t0\t0\t1
5\t0\t2\t20\t0\t0\t0\t0\t0\t0\t0\t1
"""

FENCE = "# a field\n47.3977 8.5456\n47.40 8.54\n47.40 8.55\n47.39 8.55\n47.39 8.54\n47.40 8.54\n"
RALLY = "RALLY 47.396 8.544 25 0 0 0\nRALLY\t47.395\t8.545\t15.5\t0\t0\t0\n"

NUMBERS = st.floats(allow_infinity=False, width=64)
LATITUDES = st.floats(-90, 90, allow_nan=False)
LONGITUDES = st.floats(-180, 180, allow_nan=False)
PLACES = st.tuples(LATITUDES, LONGITUDES)
SMALL = st.floats(-1e6, 1e6, allow_nan=False)
#: Commands whose params are only numbers to a file.
COMMANDS = st.integers(0, 0xFFFF).filter(lambda command: command not in (CMD.DO_JUMP, CMD.NAV_RALLY_POINT))
ABOVE_HOME = st.just(int(FRAME.GLOBAL_RELATIVE_ALT))
FRAMES = st.sampled_from([frame for frame in FRAME if plain_frame(frame) == frame])


@st.composite
def missions(draw: st.DrawFn, numbers: st.SearchStrategy[float] = NUMBERS) -> list[MissionItem]:
    params = st.tuples(*[numbers] * 4, numbers, numbers, numbers)
    items = [
        item_of(command, values, frame, autocontinue=proceeds)
        for command, values, frame, proceeds in draw(
            st.lists(st.tuples(COMMANDS.filter(_is_flown), params, FRAMES, st.booleans()), max_size=8)
        )
    ]
    for target in draw(st.lists(st.integers(0, 7), max_size=2)):
        if target < len(items):
            items.append(MissionItem(CMD.DO_JUMP, float(target), 2.0, frame=FRAME.MISSION))
    return items


def _is_flown(command: int) -> bool:
    return not CMD.NAV_FENCE_RETURN_POINT <= command <= CMD.NAV_FENCE_RETURN_POINT + 99


HOMES = st.builds(Home, LATITUDES, LONGITUDES, SMALL).filter(
    lambda home: bool(home.latitude or home.longitude or home.altitude)
)
POLYGONS = st.builds(Polygon, st.booleans(), st.lists(PLACES, min_size=3, max_size=6).map(tuple))
CIRCLES = st.builds(Circle, st.booleans(), PLACES, st.floats(0.1, 1e5))
RETURNS = st.builds(ReturnPoint, PLACES, SMALL)
FENCES = st.builds(
    FenceAreas, st.lists(POLYGONS, max_size=3), st.lists(CIRCLES, max_size=3), st.lists(RETURNS, max_size=1)
).map(fence_items)


@st.composite
def rally_points(draw: st.DrawFn, frames: st.SearchStrategy[int] = ABOVE_HOME) -> list[MissionItem]:
    points = draw(st.lists(st.tuples(PLACES, SMALL, frames), max_size=4))
    return [
        item_of(CMD.NAV_RALLY_POINT, (0, 0, 0, 0, *place, altitude), frame, autocontinue=False)
        for place, altitude, frame in points
    ]


def exactly(plan: PlanFile) -> list[object]:
    """All of a plan, with its floats as they are and NaN equal to itself."""
    kinds = (plan.mission, plan.fence, plan.rally)
    return [plan.home, *[[stored_values(item) for item in each.items] for each in kinds]]


def stored_values(item: MissionItem) -> tuple[object, ...]:
    params = tuple("nan" if isnan(value) else float(value) for value in params_of(item))
    return int(item.command), plain_frame(item.frame), item.autocontinue, params


def names(plan: Plan) -> list[str]:
    return [item.name for item in plan.items]
