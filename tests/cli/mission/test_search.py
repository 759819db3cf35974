"""`mav swarm search`: plans, files and uploads."""

from __future__ import annotations

import json

import pytest

from mavstack.files.plans import read_plan
from tests.cli.harness import COPTER, PX4_COPTER

CENTER = ("--center", "47.3977,8.5456")


def test_a_dry_run_divides_the_pattern_without_vehicles(mav):
    result = mav("swarm", "search", "parallel", *CENTER, "--size", 200, "--count", 4, "--dry-run", "--json")
    assert (result.code, result.err) == (0, "")
    plan = json.loads(result.out)
    lengths = [each["length_m"] for each in plan["vehicles"]]
    assert sum(lengths) == pytest.approx(2000.0, abs=1.0)
    assert max(lengths) / min(lengths) < 1.05
    assert [each["altitude_m"] for each in plan["vehicles"]] == [30.0, 40.0, 50.0, 60.0]
    assert not plan["uploaded"]
    for each in plan["vehicles"]:
        names = [item["command"] for item in each["items"]]
        assert (names[0], names[-1]) == ("NAV_TAKEOFF", "NAV_RETURN_TO_LAUNCH")
        places = [item["params"][4:6] for item in each["items"] if item["command"] == "NAV_WAYPOINT"]
        assert places == [place[:2] for place in each["waypoints"]]
        assert all(abs(lat - 47.3977) < 1e-3 and abs(lon - 8.5456) < 1.5e-3 for lat, lon in places)


@pytest.mark.parametrize("pattern", ["creeping", "square", "sector"])
def test_other_patterns_are_plans_too(mav, pattern):
    result = mav("swarm", "search", pattern, *CENTER, "--bearing", 30, "--dry-run")
    assert result.code == 0
    assert result.out.startswith("vehicle 1: ")


def test_files_are_written_for_each_vehicle(mav, tmp_path):
    out = tmp_path / "search.plan"
    assert mav("swarm", "search", "parallel", *CENTER, "--count", 2, "--out", out).code == 0
    plans = [read_plan(tmp_path / f"search-{system}.plan") for system in (1, 2)]
    assert all(len(plan.mission) > 4 for plan in plans)
    assert all(not plan.problems for plan in plans)


def test_missions_are_uploaded(simulate, mav):
    harness = simulate(COPTER, PX4_COPTER, apart=True)
    result = mav("swarm", "search", "parallel", *CENTER, "--spacing", 50)
    assert (result.code, result.err) == (0, "")
    assert [line.partition(":")[0] for line in result.out.splitlines()] == ["vehicle 1", "vehicle 2"]
    downloaded = [mav("mission", "download", "-", "--system", system).out for system in (1, 2)]
    assert all(text.count("\n") > 5 for text in downloaded)
    assert len(harness.simulation.vehicles) == 2


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("--count", 2), "add --dry-run or --out FILE"),
        (("--start", "--dry-run"), "--start uploads the missions"),
        (("--center", "here"), "is not a place such as"),
        (("--count", 0), "is not a number of vehicles"),
    ],
)
def test_wrong_usage_is_refused(mav, words, text):
    result = mav("swarm", "search", "parallel", *CENTER, *words)
    assert result.code == 2
    assert text in result.err
