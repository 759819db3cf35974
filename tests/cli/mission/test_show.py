"""`mav mission show`: tables, maps, JSON and problems."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from tests.files.plans.plans import FLIGHT

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from mavstack.vehicle import Vehicle

    Work = Callable[[Vehicle], Awaitable[int]]


def test_show_as_table_and_map(mav):
    result = mav("mission", "show", "flight.plan")
    assert (result.code, result.err) == (0, "")
    lines = result.out.splitlines()
    assert lines[0] == "flight.plan: a mission of 5 items, 231 m; a fence of 2 areas; 2 rally points"
    assert lines[2].split() == ["#", "command", "place", "altitude", "distance", "params"]
    table = [line.split("  ") for line in lines[3:9]]
    assert [[word.strip() for word in row if word.strip()] for row in table] == [
        ["0", "home", "47.3977419 8.5455939", "488 m above sea"],
        ["1", "NAV_TAKEOFF", "here", "20 m above home"],
        ["2", "NAV_WAYPOINT", "47.3980000 8.5460000", "30 m above home", "42 m", "Hold 3 s"],
        ["3", "NAV_WAYPOINT", "47.3985000 8.5450000", "520.25 m above sea", "94 m", "Yaw 90°, stops here"],
        ["4", "DO_JUMP", "to 2, Repeat 3"],
        ["5", "NAV_RETURN_TO_LAUNCH", "95 m"],
    ]
    assert "stay inside the polygon of 4 vertices" in lines
    assert "stay outside the circle of 25.5 m around 47.3990000 8.5490000" in lines
    assert "return to 47.3977000 8.5456000, 30 m" in lines
    assert "north is up" in lines[-1]
    sketch = "\n".join(lines[-19:])
    assert "H" in sketch
    assert "3" in sketch
    without = mav("mission", "show", "flight.plan", "--no-map").out
    assert result.out.startswith(without)
    assert "north is up" not in without


def test_show_problems(mav, files):
    (files / "bad.plan").write_text(FLIGHT.replace("47.3980", "147.3980").replace("[2, 3,", "[9, 3,"))
    result = mav("mission", "show", "bad.plan", "--no-map")
    assert result.code == 0
    assert result.out.splitlines()[-3:] == [
        "problem: item 4 jumps to doJumpId 9, which no item has",
        "problem: mission item 2: NAV_WAYPOINT: latitude 147.398 is not between -90 and 90",
        "problem: mission item 4: DO_JUMP: it jumps to item 0, but the mission's items are 1 to 5",
    ]


def test_show_as_json(mav):
    shown = json.loads(mav("mission", "show", "flight.plan", "--json").out)
    assert shown["home"] == {"latitude": 47.3977419, "longitude": 8.5455939, "altitude": 488}
    assert [item["name"] for item in shown["mission"]][3:] == ["DO_JUMP", "NAV_RETURN_TO_LAUNCH"]
    assert shown["mission"][3]["params"][:2] == [1, 3]
    assert shown["mission"][1]["distance_m"] == pytest.approx(42, abs=1)
    assert shown["length_m"] == pytest.approx(
        sum(item["distance_m"] or 0 for item in shown["mission"]), abs=0.1
    )
    assert (len(shown["fence"]), len(shown["rally"])) == (6, 2)


def test_map_of_many_items_is_legible(mav, files):
    rows = [f"{seq} 0 3 16 0 0 0 0 {47 + seq % 2 / 1000} {8 + seq / 1000} 20 1" for seq in range(1, 101)]
    (files / "many.txt").write_text("\n".join(["QGC WPL 110", "0 1 0 16 0 0 0 0 47 8 400 1", *rows]))
    sketch = mav("mission", "show", "many.txt").out.splitlines()[104:]
    words = " ".join(sketch[:-1])
    for number in ("H", "1", "50", "100"):
        assert number in words
    assert "47" not in words
    assert max(map(len, sketch)) <= 67


@pytest.mark.parametrize("name", ["flight.waypoints", "area.fen", "places.rally"])
def test_show_every_format(mav, name):
    result = mav("mission", "show", name)
    assert (result.code, result.err) == (0, "")
    assert result.out.startswith(f"{name}: ")
