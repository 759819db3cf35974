"""`mav mission`, against simulated vehicles in virtual time and against one that misbehaves."""

from __future__ import annotations

import json
import shlex
from typing import TYPE_CHECKING

import pytest

from mavstack.cli.mission import command
from mavstack.dialects import common
from mavstack.files.plans import parse_plan, read_plan
from mavstack.services.mission import PlanType
from tests.files.plans.plans import FLIGHT

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from mavstack.vehicle import Vehicle

    Work = Callable[[Vehicle], Awaitable[int]]

_RESULT = common.MavMissionResult


@pytest.mark.fast_cases(1)
def test_uploaded_plans_are_downloaded_equal(mav, target):
    result = mav("mission", "upload", "flight.plan", "--verify")
    assert (result.code, result.err) == (0, "")
    assert result.out.splitlines() == [
        "vehicle 1: fence: 6 items uploaded and verified",
        "vehicle 1: rally points: 2 items uploaded and verified",
        "vehicle 1: mission: 5 items uploaded and verified",
    ]
    result = mav("mission", "download", "back.plan")
    assert (result.code, result.err) == (0, "")
    assert result.out == "back.plan: mission: 5 items, fence: 6 items, rally points: 2 items\n"
    given, got = read_plan("flight.plan"), read_plan("back.plan")
    assert len(got.mission) == 5
    assert got.mission.items[3] == given.mission.items[3]  # the jump
    assert [item.name for item in got.mission.items] == [item.name for item in given.mission.items]
    assert got.home is not None
    assert got.home.latitude == pytest.approx(47.3977, abs=1e-3)
    assert got.settings.vehicle_type == common.MavType.QUADROTOR


@pytest.mark.fast_cases(1)
def test_jump_targets_follow_the_numbering_of_the_vehicle(mav, target):
    assert (
        mav("mission", "upload", "flight.plan", "--mission").out == "vehicle 1: mission: 5 items uploaded\n"
    )
    held = target.vehicle.plans.get(PlanType.MISSION)
    jump = next(item for item in held.items if item.command == common.MavCmd.DO_JUMP)
    destination = held.items[int(jump.param1)]
    assert (destination.command, destination.param1) == (common.MavCmd.NAV_WAYPOINT, 3)


@pytest.mark.flight
def test_standard_output_has_the_default_format(mav, copter):
    assert mav("mission", "upload", "flight.plan").code == 0
    result = mav("mission", "download")
    assert (result.code, result.err) == (0, "")
    assert result.out.startswith("QGC WPL 110\n0\t1\t0\t16\t")
    assert len(parse_plan(result.out).mission) == 5
    result = mav("mission", "download", "--rally", "--format", "rally")
    assert result.out == "RALLY 47.396 8.544 25 0 0 0\nRALLY 47.395 8.545 15.5 0 0 0\n"


@pytest.mark.flight
def test_lossy_format_needs_force(mav, copter, files):
    assert mav("mission", "upload", "flight.plan", "--fence").code == 0
    result = mav("mission", "download", "back.fen")
    assert (result.code, result.out) == (1, "")
    assert result.err.count("\n") == 1
    assert result.err.startswith("mav mission: back.fen: the format 'fence' cannot hold circles (1)")
    assert not (files / "back.fen").exists()
    result = mav("mission", "download", "back.fen", "--force")
    assert result.code == 0
    assert "note: circles (1)" in result.err
    assert len(read_plan("back.fen").fence) == 5


@pytest.mark.flight
def test_json_output_can_be_uploaded(mav, copter, files):
    mav("mission", "upload", "flight.plan")
    shown = mav("mission", "show", "--json")
    assert (shown.code, shown.err) == (0, "")
    assert json.loads(shown.out)["problems"] == []
    (files / "shown.json").write_text(shown.out)
    assert (
        mav("mission", "clear", "--all-plans").out
        == "vehicle 1: fence: cleared\nvehicle 1: rally points: cleared\nvehicle 1: mission: cleared\n"
    )
    assert json.loads(mav("mission", "show", "--json").out)["mission"] == []
    assert mav("mission", "upload", "shown.json", "--verify").code == 0
    again = json.loads(mav("mission", "show", "--json").out)
    assert [again[key] for key in ("mission", "fence", "rally")] == [
        json.loads(shown.out)[key] for key in ("mission", "fence", "rally")
    ]


@pytest.mark.fast_cases(1)
def test_start_and_wait_for_completion(mav, target):
    mav("mission", "upload", "hop.waypoints")
    result = mav("mission", "start", "--wait")
    assert (result.code, result.out, result.err) == (0, "vehicle 1: mission: complete\n", "")
    assert target.vehicle.body.truth.north == pytest.approx(6.5, abs=1.5)
    assert target.vehicle.body.on_ground


@pytest.mark.fast_cases(1)
def test_start(mav, target):
    mav("mission", "upload", "flight.waypoints")
    result = mav("mission", "start")
    assert (result.code, result.out, result.err) == (0, "vehicle 1: mission: started\n", "")
    assert target.vehicle.autopilot.armed


@pytest.mark.fast_cases(1)
def test_start_without_a_mission_does_not_arm(mav, target):
    for words in (("start",), ("start", "--wait")):
        result = mav("mission", *words)
        assert (result.code, result.out) == (1, "")
        assert (
            result.err == "mav mission: vehicle 1 has no mission; upload one with `mav mission upload FILE`\n"
        )
        assert not target.vehicle.autopilot.armed


@pytest.mark.flight
def test_clear_deletes_only_the_mission(mav, copter):
    mav("mission", "upload", "flight.plan")
    assert mav("mission", "clear").out == "vehicle 1: mission: cleared\n"
    shown = json.loads(mav("mission", "show", "--json").out)
    assert [len(shown[key]) for key in ("mission", "fence", "rally")] == [0, 6, 2]


# Files


def test_convert(mav, files):
    assert mav("mission", "convert", "flight.plan", "out.waypoints", "--mission").code == 0
    assert read_plan("out.waypoints").mission == read_plan("flight.plan").mission
    assert mav("mission", "convert", "area.fen", "out.plan").code == 0
    assert len(read_plan("out.plan").fence) == 5
    assert mav("mission", "convert", "places.rally", "-").out.count("\t5100\t") == 2
    result = mav("mission", "convert", "flight.plan", "out.txt")
    assert result.code == 1
    assert result.err == (
        "mav mission: out.txt: the format 'waypoints' cannot hold the fence, as this format holds one "
        "type of plan (and 1 more); --force writes the rest, .json holds everything\n"
    )
    assert not (files / "out.txt").exists()


@pytest.mark.flight
def test_unsupported_pattern_is_refused(mav, copter, files):
    pattern = '{"type": "ComplexItem", "complexItemType": "StructureScan", "version": 3}, '
    (files / "scan.plan").write_text(FLIGHT.replace('"items": [', f'"items": [{pattern}'))
    for words in (("convert", "scan.plan", "out.json"), ("upload", "scan.plan")):
        result = mav("mission", *words)
        assert (result.code, result.out) == (1, "")
        assert result.err.startswith(
            "mav mission: scan.plan: mission.items[0]: the StructureScan was not read"
        )
        assert result.err.count("\n") == 1
    assert mav("mission", "convert", "scan.plan", "out.json", "--force").code == 0
    assert mav("mission", "upload", "scan.plan", "--force").code == 0


@pytest.mark.flight
def test_invalid_plan_is_not_uploaded(mav, copter, files):
    (files / "bad.plan").write_text(FLIGHT.replace("47.3980", "147.3980").replace("8.5450", "908.5450"))
    result = mav("mission", "upload", "bad.plan")
    assert (result.code, result.out) == (1, "")
    assert result.err == (
        "mav mission: bad.plan: mission item 2: NAV_WAYPOINT: latitude 147.398 is not between -90 and 90 "
        "(and 1 more); `mav mission show bad.plan` shows all problems, --force uploads the plan\n"
    )
    result = mav("mission", "upload", "bad.plan", "--force")
    assert result.code == 1
    assert result.out == "vehicle 1: fence: 6 items uploaded\nvehicle 1: rally points: 2 items uploaded\n"
    assert "INVALID_PARAM" in result.err
    assert result.err.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("show", "missing.plan"), "missing.plan: No such file or directory"),
        (("upload", "area.fen", "--mission"), "area.fen: it has no mission"),
        (("convert", "flight.plan", "flight.kml"), "flight.kml: its suffix names no format"),
        (("convert", "flight.waypoints", "x.rally"), "x.rally: this format holds rally points, and the plan"),
        (("convert", "flight.waypoints", "no/where.plan"), "no/where.plan: No such file or directory"),
    ],
)
def test_failures_are_one_line(mav, words, expected):
    result = mav("mission", *words)
    assert (result.code, result.out) == (1, "")
    assert result.err.startswith(f"mav mission: {expected}")
    assert result.err.count("\n") == 1


@pytest.mark.parametrize("words", [(), ("fly",), ("upload",), ("convert", "a.plan"), ("show", "--fence=1")])
def test_wrong_usage(mav, words):
    assert mav("mission", *words).code == 2


def test_no_vehicle(mav):
    result = mav("mission", "show", "--url", "udpin://127.0.0.1:0", "--timeout", "0.1")
    assert (result.code, result.out) == (1, "")
    assert result.err.count("\n") == 1


EXAMPLES = [line.strip() for line in command.EXAMPLES.splitlines()[1:]]


@pytest.mark.flight
def test_examples_of_the_help_run(mav, copter, capsys):
    ran = 0
    for line in [EXAMPLES[0], *EXAMPLES]:
        if line == "mav mission start":  # they have cleared it before
            mav("mission", "upload", "hop.waypoints")
        words = shlex.split(line.partition(" > ")[0])
        result = mav(*words[1:])
        assert (result.code, line) == (0, line), result.err
        ran += 1
    assert ran == len(EXAMPLES) + 1


@pytest.mark.parametrize("action", ["upload", "download", "clear", "start", "show", "convert"])
def test_each_help_page_has_examples(mav, action):
    page = mav("mission", action, "--help")
    assert page.code == 0
    assert f"  mav mission {action}" in page.out
