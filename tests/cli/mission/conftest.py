"""Fixtures of the tests of `mav mission`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.files.plans import PlanFile, format_plan
from mavstack.files.plans.fence import FenceAreas, Polygon, fence_items
from tests.cli.mission.harness import CommandTarget, run_commands_on
from tests.files.plans.plans import FENCE, FLIGHT, RALLY, WAYPOINTS

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from pathlib import Path

    from mavstack.vehicle import Vehicle

    Work = Callable[[Vehicle], Awaitable[int]]


#: Up, a little way to the north, and down.
HOP = """\
QGC WPL 110
0 1 0 16 0 0 0 0 47.3977419 8.5455939 488 1
1 0 3 22 0 0 0 0 0 0 6 1
2 0 3 16 0 0 0 0 47.3978 8.5455939 6 1
3 0 3 21 0 0 0 0 47.3978 8.5455939 0 1
"""

#: A field of 100 by 200 metres, as the fence of a plan.
FIELD = FenceAreas(
    [Polygon(True, ((47.3970, 8.5450), (47.3970, 8.5463), (47.3988, 8.5463), (47.3988, 8.5450)))]
)


@pytest.fixture(params=["ardupilot", "px4"])
def target(request, monkeypatch) -> CommandTarget:
    target = CommandTarget(request.param)
    run_commands_on(monkeypatch, target.run_on_vehicle)
    return target


@pytest.fixture
def copter(monkeypatch) -> CommandTarget:
    target = CommandTarget("ardupilot")
    run_commands_on(monkeypatch, target.run_on_vehicle)
    return target


@pytest.fixture(autouse=True)
def files(tmp_path, monkeypatch) -> Path:
    (tmp_path / "flight.plan").write_text(FLIGHT)
    (tmp_path / "flight.waypoints").write_text(WAYPOINTS)
    (tmp_path / "hop.waypoints").write_text(HOP)
    (tmp_path / "field.plan").write_text(format_plan(PlanFile.of(fence=fence_items(FIELD)), "plan").text)
    (tmp_path / "area.fen").write_text(FENCE)
    (tmp_path / "places.rally").write_text(RALLY)
    monkeypatch.chdir(tmp_path)
    return tmp_path
