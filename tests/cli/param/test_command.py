from __future__ import annotations

import asyncio
import json
import re

import pytest

from mavstack.cli.param.command import EXAMPLES
from mavstack.files.parameters import read_parameters
from mavstack.sim.vehicle_types import VehicleType
from tests.cli.harness import PX4_COPTER, CliHarness, examples_of


@pytest.fixture
def harness(monkeypatch):
    return CliHarness(monkeypatch)


@pytest.mark.nightly
@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_examples_of_the_help_run(mav, monkeypatch, tmp_path, firmware):
    harness = CliHarness(monkeypatch, (VehicleType.COPTER, firmware))
    monkeypatch.chdir(tmp_path)
    of_px4 = {
        "RTL*": "RTL*",
        "SYSID_THISMAV": "MAV_SYS_ID",
        "RTL_ALT": "RTL_RETURN_ALT",
        "3000": "45",
        "1,3-5": "1",
        "RTL_ALT=3000": "RTL_RETURN_ALT=45",
        "RTL_SPEED=500": "RTL_DESCEND_ALT=20",
        "ATC*": "MC*",
        "PSC*": "MPC*",
    }
    (tmp_path / "before.param").write_text("RTL_ALT,1\nOLD,2\n")
    (tmp_path / "after.params").write_text("1\t1\tRTL_ALT\t2\t6\n")
    (tmp_path / "apm.pdef.xml").write_text(
        '<paramfile><vehicles><parameters><param name="RTL_ALT"/></parameters></vehicles></paramfile>'
    )
    for example in examples_of(EXAMPLES):
        words = [of_px4.get(word, word) if firmware == "px4" or "," in word else word for word in example]
        result = mav(*words)
        assert result.code == (1 if "--exit-code" in words else 0), (words, result)
        assert result.out or "watch" in words, words
        assert result.err == ""
    assert read_parameters("backup.param").by_name()
    wanted = {"ardupilot": ("RTL_ALT", 3000), "px4": ("RTL_RETURN_ALT", 45)}[firmware]
    assert harness.vehicle.parameters[wanted[0]] == wanted[1]


def test_help_shows_the_examples_of_each_action(mav):
    for action in ("list", "get", "set", "save", "load", "diff", "watch"):
        result = mav("param", action, "--help")
        assert result.code == 0
        assert f"  mav param {action}" in result.out


def test_list(mav, harness):
    result = mav("param", "list", "rtl_alt", "RTL_CONE*")
    assert result.out == "RTL_ALT         1500  int32\nRTL_CONE_SLOPE     3  real32\n"
    everything = mav("param", "list", "--json")
    assert len(json.loads(everything.out)) == len(harness.vehicle.parameters)
    assert json.loads(mav("param", "list", "RTL_ALT", "--json").out) == [
        {"name": "RTL_ALT", "value": 1500, "type": "INT32"}
    ]


def test_unknown_parameter(mav, harness):
    result = mav("param", "list", "RTL_ATL")
    assert (result.code, result.out) == (1, "")
    assert result.err == "mav param: there is no parameter RTL_ATL; did you mean RTL_ALT?\n"


def test_get_shows_the_readable_parameters(mav, harness):
    result = mav("param", "get", "rtl_alt", "NOPE")
    assert (result.code, result.out) == (1, "RTL_ALT  1500  int32\n")
    assert result.err.startswith("mav param: vehicle 1: reading parameter NOPE of 1/1 failed")
    assert result.err.count("\n") == 1


def test_set(mav, harness):
    assert mav("param", "set", "rtl_alt", "3000").out == "vehicle 1: RTL_ALT: 1500 -> 3000\n"
    assert mav("param", "set", "RTL_ALT", "3000").out == "vehicle 1: RTL_ALT: 3000, unchanged\n"
    assert (
        mav("param", "set", "FRAME_CLASS=2").out
        == "vehicle 1: FRAME_CLASS: 1 -> 2; takes effect after a reboot\n"
    )
    printed = json.loads(mav("param", "set", "PSC_POSZ_P", "0.7", "--json").out)
    assert (printed["name"], printed["value"], printed["before"], printed["needs_reboot"]) == (
        "PSC_POSZ_P",
        0.7,
        1,
        False,
    )
    assert harness.vehicle.parameters["RTL_ALT"] == 3000


def test_set_continues_after_a_refusal(mav, harness):
    result = mav("param", "set", "STAT_BOOTCNT=9", "RTL_ALT=2000", "--force")
    assert (result.code, result.out) == (1, "vehicle 1: RTL_ALT: 1500 -> 2000\n")
    assert result.err.startswith("mav param: vehicle 1: setting parameter STAT_BOOTCNT to 9 on 1/1 failed")
    assert "READ_ONLY" in result.err
    assert result.err.count("\n") == 1


def test_value_out_of_the_range_of_its_type(mav, harness):
    result = mav("param", "set", "FRAME_CLASS", "300", "--force")
    assert result.code == 1
    assert result.err == "mav param: FRAME_CLASS is of type INT8, which cannot hold 300\n"


@pytest.mark.parametrize(
    "words",
    [
        ["set", "RTL_ALT"],
        ["set", "RTL_ALT", "many"],
        ["set", "RTL_ALT=1", "RTL_SPEED"],
        ["get"],
        ["save", "x.unknown"],
        ["save", "-"],
        ["save", "x.param", "--format", "xml"],
        ["diff", "a", "b", "c"],
        ["watch", "--for", "never"],
        ["list", "--system", "300"],
        ["list", "--url", "nonsense://1"],
        ["dance"],
        [],
    ],
)
def test_wrong_usage(mav, tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    for name in "abc":
        (tmp_path / name).write_text("A 1\n")
    result = mav("param", *words)
    assert (result.code, result.out) == (2, ""), result
    assert result.err


def test_link_cannot_be_opened(mav):
    result = mav("param", "list", "--url", "serial:///dev/no-such-port")
    assert result.code == 1
    assert result.err.startswith("mav param: ")
    assert result.err.count("\n") == 1


@pytest.mark.flight
def test_no_vehicle(mav, harness):
    result = mav("param", "list", "--system", "77", "--timeout", "3")
    assert result.code == 1
    assert "vehicle 77" in result.err
    harness.vehicle.cut(True)
    result = mav("param", "list", "--timeout", "3")
    assert result.code == 1
    assert "waiting for" in result.err
    assert result.err.count("\n") == 1


def test_save(mav, harness, tmp_path):
    path = tmp_path / "a.params"
    assert mav("param", "save", path, "RTL*").out == f"vehicle 1: 8 parameters in {path}\n"
    printed = json.loads(mav("param", "save", path, "--json").out)
    assert printed == {
        "system": 1,
        "file": str(path),
        "format": "qgroundcontrol",
        "parameters": len(harness.vehicle.parameters),
    }
    text = path.read_text()
    assert text.startswith(
        "# Onboard parameters for Vehicle 1\n#\n# Stack: ArduPilot\n# Vehicle: quadrotor\n# Version: 4"
    )
    assert mav("param", "save", "-", "RTL_ALT", "--format", "mission-planner").out.endswith("RTL_ALT,1500\n")


def test_failed_save_keeps_the_old_file(mav, harness, tmp_path):
    result = mav("param", "save", tmp_path / "nowhere" / "a.param")
    assert result.code == 1
    assert result.err.count("\n") == 1


LOADED = """\
RTL_ALT         1500 -> 3000
STAT_BOOTCNT    1 -> 77       skipped: the vehicle counts or measures it itself
FRAME_CLASS     1 -> 300      refused: its type INT8 cannot hold 300
FOO_BAR         3             unknown: the vehicle has no such parameter
FRAME_TYPE      0 -> 3        takes effect after a reboot
"""


@pytest.mark.flight
def test_load_reports_the_outcome_of_each_parameter(mav, harness, tmp_path):
    path = tmp_path / "a.parm"
    path.write_text("RTL_ALT 3000\nSTAT_BOOTCNT 77\nFRAME_CLASS 300\nFOO_BAR 3\nRTL_SPEED 0\nFRAME_TYPE 3\n")
    old = harness.vehicle.parameters["FRAME_TYPE"]
    dry = mav("param", "load", path, "--dry-run")
    assert dry.code == 1
    assert dry.out.splitlines()[-1].startswith(
        "vehicle 1: 2 to be set, 1 unchanged, 1 skipped, 1 refused, 1 unknown; nothing"
    )
    assert harness.vehicle.parameters["RTL_ALT"] == 1500
    result = mav("param", "load", path)
    assert (result.code, result.err) == (1, "")
    expected = [line.split() for line in LOADED.replace("0 -> 3 ", f"{old} -> 3 ").splitlines()]
    lines = result.out.splitlines()
    assert [line.split() for line in lines[:-1]] == expected
    counts = "2 set, 1 unchanged, 1 skipped, 1 refused, 1 unknown"
    assert lines[-1] == f"vehicle 1: {counts}; --everything also sets the skipped ones; reboot the vehicle"
    assert harness.vehicle.parameters["RTL_ALT"] == 3000
    again = mav("param", "load", path, "RTL*", "--json")
    printed = json.loads(again.out)
    assert again.code == 0
    assert [(each["name"], each["outcome"]) for each in printed["parameters"]] == [
        ("RTL_ALT", "unchanged"),
        ("RTL_SPEED", "unchanged"),
    ]


def test_load_all_sets_vehicle_specific_parameters(mav, harness, tmp_path):
    path = tmp_path / "a.param"
    path.write_text("COMPASS_OFS_X,12.5\n")
    assert "skipped" in mav("param", "load", path).out
    assert mav("param", "load", path, "--everything").out.startswith("COMPASS_OFS_X  ")
    assert harness.vehicle.parameters["COMPASS_OFS_X"] == 12.5


def test_file_of_another_component(mav, harness, tmp_path):
    path = tmp_path / "camera.params"
    path.write_text("1\t100\tCAM_MODE\t1\t6\n")
    for action in ("load", "diff"):
        result = mav("param", action, path)
        assert (result.code, result.out) == (1, "")
        assert result.err == f"mav param: {path}: it has only parameters of component 100, not of 1\n"


def test_invalid_file_is_reported_before_connecting(mav, monkeypatch, tmp_path):
    path = tmp_path / "a.param"
    path.write_text("RTL_ALT,1\nRTL_SPEED,fast\n")
    result = mav("param", "load", path)
    assert result.code == 1
    assert result.err == f"mav param: {path}:2: 'fast' is not a number; correct or remove RTL_SPEED\n"
    assert mav("param", "diff", tmp_path / "missing").code == 1


@pytest.mark.flight
def test_diff_with_the_vehicle(mav, harness, tmp_path):
    path = tmp_path / "a.param"
    mav("param", "save", path)
    same = mav("param", "diff", path, "--exit-code")
    assert same.code == 0
    assert same.out.endswith(" equal\n")
    mav("param", "set", "RTL_ALT", "1501")
    assert mav("param", "diff", path).code == 0
    result = mav("param", "diff", path, "--exit-code")
    assert result.code == 1
    assert [line.split() for line in result.out.splitlines()][:2] == [
        [str(path), "vehicle", "1"],
        ["RTL_ALT", "1500", "1501"],
    ]
    printed = json.loads(mav("param", "diff", path, "--json").out)
    assert printed["different"] == [{"name": "RTL_ALT", "ours": 1500, "theirs": 1501}]


@pytest.mark.flight
def test_diff_with_some_parameters_of_the_vehicle(mav, harness, tmp_path):
    path = tmp_path / "a.param"
    path.write_text("RTL_ALT,1500\n")
    others = len(harness.vehicle.parameters) - 1
    assert mav("param", "diff", path).out == (
        f"vehicle 1: 1 equal, {others} only on the vehicle (--everything shows them)\n"
    )
    assert len(mav("param", "diff", path, "--everything").out.splitlines()) == others + 2


def test_diff_of_two_files(mav, tmp_path):
    one, other = tmp_path / "a.param", tmp_path / "b.params"
    one.write_text("A,1\nB,2.5\nSTAT_RUNTIME,7\n")
    other.write_text("1\t1\tB\t2.50000000\t9\n1\t1\tC\t4\t6\n1\t1\tSTAT_RUNTIME\t9\t6\n")
    result = mav("param", "diff", one, other, "--json")
    assert json.loads(result.out) == {
        "same": 1,
        "different": [
            {"name": "A", "ours": 1, "theirs": None},
            {"name": "C", "ours": None, "theirs": 4},
        ],
    }
    assert len(json.loads(mav("param", "diff", one, other, "--json", "--everything").out)["different"]) == 3


@pytest.mark.nightly
def test_watch_shows_changes_of_another_station(mav, harness):
    async def other_station(remote):
        await asyncio.sleep(20)
        await remote.params.set("RTL_ALT", 2222)
        await remote.params.set("FRAME_TYPE", 3)

    harness.meanwhile = other_station
    result = mav("param", "watch", "RTL*", "--for", "60")
    assert (result.code, result.out, result.err) == (0, "RTL_ALT: 1500 -> 2222\n", "")
    harness.vehicle.parameters.set("RTL_ALT", 1500)
    printed = json.loads(mav("param", "watch", "RTL*", "--for", "60", "--json").out)
    assert printed == {"system": 1, "name": "RTL_ALT", "value": 2222, "type": "INT32", "before": 1500}


def cut_at(harness, name):
    """Cut the vehicle's link as soon as a parameter changes."""
    harness.vehicle.parameters.on_change(name, lambda value: harness.vehicle.cut(True))


def test_vehicle_falls_silent_during_load(mav, harness, tmp_path):
    path = tmp_path / "a.param"
    path.write_text("".join(f"SERVO{number}_MIN,1099\n" for number in range(1, 17)))
    cut_at(harness, "SERVO3_MIN")
    result = mav("param", "load", path)
    assert (result.code, result.err) == (1, "")
    lines = result.out.splitlines()
    assert len(lines) == 17
    assert any(line.endswith("unanswered: no answer") for line in lines)
    assert any(line.endswith("untried: the vehicle no longer answers") for line in lines)
    assert "untried" in lines[-1]


def test_vehicle_falls_silent_during_set(mav, harness):
    cut_at(harness, "RTL_ALT")
    result = mav("param", "set", "RTL_ALT=2000", "RTL_SPEED=5")
    assert (result.code, result.out) == (1, "vehicle 1: RTL_ALT: 1500 -> 2000\n")
    assert result.err.startswith("mav param: vehicle 1: reading parameter RTL_SPEED of 1/1 failed ")
    assert " attempts: no answer" in result.err
    assert result.err.count("\n") == 1


def test_parameters_that_take_too_long_end_with_the_option_that_allows_it(mav, simulate, monkeypatch):

    monkeypatch.setattr("mavstack.services.parameters.listing.Listing.min_rate", 1e9)
    monkeypatch.setattr("mavstack.services.operation.SLOW_START", 0.2)
    simulate(PX4_COPTER)
    result = mav("param", "list")
    assert result.code == 1
    assert re.fullmatch(
        r"mav param: .* failed: too slow, only \d+ arrived in [0-9.]+ s; --action-timeout allows more time\n",
        result.err,
    )
    assert mav("param", "list", "--action-timeout", 600).code == 0
