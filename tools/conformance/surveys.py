"""Surveys and searches with their plans, for other implementations of the planner."""

from __future__ import annotations

import json
from typing import Any, Final

from mavstack.http.request_fields import read_fields
from mavstack.server.api.surveys import PlanSearch, PlanSurvey, plan_pattern, plan_survey

_Place = list[float]


def _around(latitude: float, longitude: float, *corners: tuple[float, float]) -> list[_Place]:
    """Return corners in degrees, given in units of 0.0001 degrees."""
    return [[round(latitude + north / 1e4, 7), round(longitude + east / 1e4, 7)] for north, east in corners]


_SQUARE: Final = _around(47.397, 8.545, (0, 0), (0, 26), (18, 26), (18, 0))
_L_SHAPE: Final = _around(47.397, 8.545, (0, 0), (0, 40), (10, 40), (10, 15), (30, 15), (30, 0))
_U_SHAPE: Final = _around(
    -33.86, 151.2, (0, 0), (30, 0), (30, 10), (8, 10), (8, 25), (30, 25), (30, 35), (0, 35)
)
_POND: Final = _around(47.397, 8.545, (6, 6), (6, 14), (12, 14), (12, 6))
_SLANTED: Final = _around(47.397, 8.545, (0, 0), (5, 30), (21, 34), (24, 6))
_ROUTE: Final = _around(60.17, 24.94, (0, 0), (20, 10), (25, 40), (50, 45))
_THREE: Final = [
    {"system": 1, "speed": 5.0, "start": [47.397, 8.545]},
    {"system": 2, "speed": 10.0, "start": [47.3988, 8.5476]},
    {"system": 3, "speed": 5.0, "endurance": 2.0, "start": [47.397, 8.5476]},
]

#: Requests of `POST /api/surveys` by name.
SURVEYS: Final[dict[str, dict[str, Any]]] = {
    "rectangle": {"outline": _SQUARE, "spacing": 20.0},
    "rectangle-bearing": {"outline": _SQUARE, "spacing": 25.0, "bearing": 30.0},
    "slanted": {"outline": _SLANTED, "spacing": 15.0, "speed": 6.0},
    "concave": {"outline": _L_SHAPE, "spacing": 20.0},
    "two-cells": {"outline": _U_SHAPE, "spacing": 20.0, "bearing": 90.0},
    "obstacle": {"outline": _SQUARE, "spacing": 12.0, "obstacles": [_POND], "bearing": 0.0},
    "crosshatch": {"outline": _SLANTED, "spacing": 30.0, "crosshatch": True},
    "camera": {
        "outline": _SQUARE,
        "altitude": 60.0,
        "camera": {"horizontal_view": 73.7, "vertical_view": 53.1, "width": 5472},
        "side_overlap": 0.65,
        "front_overlap": 0.8,
    },
    "wing": {"outline": _SQUARE, "spacing": 10.0, "turn_radius": 30.0, "bearing": 90.0},
    "three-strips": {"outline": _SQUARE, "spacing": 15.0, "vehicles": _THREE, "speed": 5.0},
    "three-regions": {
        "outline": _SQUARE,
        "spacing": 15.0,
        "vehicles": _THREE,
        "division": "grid",
        "obstacles": [_POND],
    },
    "corridor": {"route": _ROUTE, "width": 60.0, "spacing": 20.0},
    "no-takeoff": {
        "outline": _SQUARE,
        "spacing": 50.0,
        "altitude": 40.0,
        "take_off": False,
        "return_home": False,
    },
}
#: Requests of `POST /api/searches` by name.
SEARCHES: Final[dict[str, dict[str, Any]]] = {
    f"search-{pattern}": {"pattern": pattern, "center": [47.3977, 8.5456], "size": 200.0, "bearing": 20.0}
    for pattern in ("parallel", "creeping", "square", "sector")
}


def survey_files() -> dict[str, str]:
    """Return the text of each file by its name."""
    surveys = {
        name: _text(name, "/api/surveys", request, plan_survey(read_fields(PlanSurvey, request)))
        for name, request in SURVEYS.items()
    }
    searches = {
        name: _text(name, "/api/searches", request, plan_pattern(read_fields(PlanSearch, request)))
        for name, request in SEARCHES.items()
    }
    return {f"{name}.json": text for name, text in {**surveys, **searches}.items()}


def _text(name: str, path: str, request: dict[str, Any], plan: dict[str, Any]) -> str:
    """Return a case as JSON, with a line for each leg and item."""
    shares = [
        {**share, "legs": [*map(_Line, share["legs"])], "items": [*map(_Line, share["items"])]}
        for share in plan["shares"]
    ]
    lines: list[str] = []

    def line(value: object) -> str:
        lines.append(json.dumps(value.value, separators=(", ", ": ")) if isinstance(value, _Line) else "")
        return f"@{len(lines) - 1}@"

    case = {"name": name, "path": path, "request": request, "plan": {**plan, "shares": shares}}
    text = json.dumps(case, indent=1, default=line)
    for index, each in enumerate(lines):
        text = text.replace(f'"@{index}@"', each, 1)
    return text + "\n"


class _Line:
    """A value that is written in one line."""

    def __init__(self, value: object) -> None:
        self.value = value
