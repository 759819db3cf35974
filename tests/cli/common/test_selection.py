"""The vehicles that commands act on: never one by chance, and always named."""

from __future__ import annotations

import json
from argparse import ArgumentTypeError

import pytest

from mavstack.cli.common.selection import system_ids
from tests.cli.harness import COPTER, PX4_COPTER

PLAN = """\
QGC WPL 110
0 1 0 16 0 0 0 0 47.3977419 8.5455939 488 1
1 0 3 22 0 0 0 0 0 0 6 1
2 0 3 16 0 0 0 0 47.3978 8.5455939 6 1
"""
CHANGES = [
    "vehicle arm", "vehicle disarm", "vehicle takeoff", "vehicle land", "vehicle rtl", "vehicle hold",
    "vehicle goto 47.39 8.54", "vehicle orbit 47.39 8.54", "vehicle mode guided", "vehicle speed 5",
    "vehicle yaw 9", "vehicle home here", "vehicle reboot",
    "param set RTL_ALT 2000", "param load x.param", "mission upload x.waypoints", "mission clear",
    "mission start", "ftp put x.param /x", "ftp rm /x", "ftp mkdir /x", "ftp rename /x /y", "log erase --yes",
    "shell --command 'arm'", "shell --command 'param set RTL_ALT 2000'", "shell --command guided",
]  # fmt: skip


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.param").write_text("RTL_ALT,2000\n")
    (tmp_path / "x.waypoints").write_text(PLAN)
    return tmp_path


@pytest.mark.fast_cases(6)
@pytest.mark.parametrize("line", CHANGES)
def test_changes_need_a_selection_if_several_vehicles_are_heard(mav, simulate, files, line):
    import shlex

    harness = simulate(COPTER, COPTER)
    result = mav(*shlex.split(line))
    assert result.code in (1, 2)
    assert result.out == ""
    assert "more than one vehicle is heard (1, 2); select one with --system ID" in result.err
    assert not any(vehicle.autopilot.armed for vehicle in harness.simulation.vehicles)
    assert {vehicle.parameters["RTL_ALT"] for vehicle in harness.simulation.vehicles} == {1500}


def test_selected_vehicle_is_changed_and_named(mav, simulate, files):
    harness = simulate(COPTER, COPTER)
    first, second = harness.simulation.vehicles
    changed = mav("param", "set", "RTL_ALT", "2700", "--system", 2)
    assert (changed.code, changed.err) == (0, "")
    assert changed.out == "vehicle 2: RTL_ALT: 1500 -> 2700\n"
    assert (first.parameters["RTL_ALT"], second.parameters["RTL_ALT"]) == (1500, 2700)
    data = json.loads(mav("param", "set", "RTL_ALT", "2800", "--system", 2, "--json").out)
    assert data["system"] == 2
    loaded = mav("param", "load", "x.param", "--system", 2)
    assert loaded.out.splitlines()[-1] == "vehicle 2: 1 set"
    assert (
        mav("mission", "upload", "x.waypoints", "--system", 2).out == "vehicle 2: mission: 2 items uploaded\n"
    )
    assert mav("ftp", "put", "x.param", "/x.param", "--system", 2).out.startswith(
        "vehicle 2: x.param -> /x.param"
    )
    assert mav("ftp", "mkdir", "/made", "--system", 2).out == "vehicle 2: /made made\n"
    assert (
        mav("ftp", "rename", "/x.param", "/y.param", "--system", 2).out == "vehicle 2: /x.param -> /y.param\n"
    )
    assert mav("ftp", "rm", "/y.param", "--system", 2).out == "vehicle 2: /y.param removed\n"
    assert mav("log", "erase", "--yes", "--system", 2).out == "vehicle 2: 0 logs erased\n"
    assert mav("shell", "--command", "arm", "--system", 2).out == "vehicle 2: armed\n"


@pytest.mark.parametrize(
    "line", ["param get RTL_ALT", "vehicle info", "mission show", "log list", "ftp ls /"]
)
def test_the_output_names_the_vehicle_that_was_read(mav, simulate, line):
    simulate(COPTER, COPTER)
    result = mav(*line.split())
    assert result.code == 0
    last = result.err.splitlines()[-1]
    assert last == f"mav {line.split()[0]}: this is vehicle 1; also heard: 2 (--system ID selects)"
    assert "this is vehicle" not in mav(*line.split(), "--system", 1).err


def test_parameters_of_a_fleet(mav, simulate, files):
    harness = simulate(COPTER, COPTER, COPTER)
    changed = mav("param", "set", "RTL_ALT", "2700", "--systems", "1,3")
    assert sorted(changed.out.splitlines()) == [f"vehicle {each}: RTL_ALT: 1500 -> 2700" for each in (1, 3)]
    loaded = mav("param", "load", "x.param", "--all")
    assert loaded.code == 0
    assert [vehicle.parameters["RTL_ALT"] for vehicle in harness.simulation.vehicles] == [2000] * 3
    read = [json.loads(line) for line in mav("param", "get", "RTL_ALT", "--all", "--json").out.splitlines()]
    assert sorted((each["system"], each["parameters"][0]["value"]) for each in read) == [
        (1, 2000),
        (2, 2000),
        (3, 2000),
    ]
    assert mav("param", "save", "v{system}.param", "--systems", "1,2").code == 0
    assert (files / "v1.param").exists()
    assert (files / "v2.param").exists()
    assert mav("param", "save", "v.param", "--all").code == 2
    refused = mav("param", "load", "x.param", "--all", "--everything")
    assert (refused.code, refused.out) == (2, "")
    assert "cannot share" in refused.err


def test_failure_of_one_vehicle_of_a_fleet(mav, simulate, files):
    harness = simulate(COPTER, PX4_COPTER)
    result = mav("param", "set", "RTL_ALT", "2700", "--all")
    assert result.code == 1
    assert result.out == "vehicle 1: RTL_ALT: 1500 -> 2700\n"
    assert result.err.startswith("mav param: vehicle 2: reading parameter RTL_ALT of 2/1 failed")
    assert harness.vehicle.parameters["RTL_ALT"] == 2700


def test_missions_of_a_fleet(mav, simulate, files):
    harness = simulate(COPTER, PX4_COPTER)
    sent = mav("mission", "upload", "x.waypoints", "--all", "--verify")
    assert (sent.code, sent.err) == (0, "")
    outcomes = sent.out.splitlines()
    assert len(outcomes) == 2
    assert all("uploaded and verified" in line for line in outcomes)
    assert {line.split(":")[0] for line in outcomes} == {"vehicle 1", "vehicle 2"}
    cleared = mav("mission", "clear", "--all-plans", "--systems", "2")
    assert cleared.out.count("vehicle 2: ") == 3
    assert "no plans" in mav("mission", "show", "--system", 2).out
    assert "a mission of 2 items" in mav("mission", "show", "--system", 1).out
    assert harness.vehicle is harness.simulation.vehicles[0]


def test_script_can_select_a_vehicle_itself(mav, simulate):
    simulate(COPTER, COPTER)
    result = mav("shell", "--command", "vehicle 2; arm")
    assert (result.code, result.out) == (0, "vehicle 2: armed\n")


@pytest.mark.parametrize(
    ("text", "ids"), [("1", [1]), ("1,3", [1, 3]), ("5-7,1,6", [5, 6, 7, 1]), (" 2 ", [2]), ("255", [255])]
)
def test_system_ids(text, ids):
    assert system_ids(text) == ids


@pytest.mark.parametrize("text", ["", "0", "256", "a", "1-", "-3", "3-1", "1,,2", "1-300", "٣"])
def test_wrong_system_ids(text):
    with pytest.raises(ArgumentTypeError):
        system_ids(text)
