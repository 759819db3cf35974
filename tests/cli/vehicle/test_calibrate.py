"""`mav vehicle calibrate`: steps, questions, results, in a pipe, on a terminal and as JSON."""

from __future__ import annotations

import json

from mavstack.cli.shell.runner import run_line
from mavstack.vehicle import CalibrationKind
from tests.cli.harness import COPTER, PX4_COPTER
from tests.cli.shell.shell_session import in_shell


def test_the_kinds_of_a_vehicle(simulate, mav):
    simulate(COPTER)
    kinds = mav("vehicle", "calibrate").out.split()
    assert kinds == [kind for kind in CalibrationKind if kind != "airspeed"]
    assert json.loads(mav("vehicle", "calibrate", "--json").out)["kinds"] == kinds


def test_a_calibration_without_questions(simulate, mav):
    simulate(PX4_COPTER)
    result = mav("vehicle", "calibrate", "gyroscope")
    assert (result.code, result.err) == (0, "")
    assert result.out == "Hold the vehicle still.\nvehicle 1: gyroscope calibration done\n"


def test_poses_are_questions(simulate, mav):
    simulate(COPTER)
    refused = mav("vehicle", "calibrate", "accelerometer")
    assert refused.code == 2
    assert "add --yes" in refused.err
    result = mav("vehicle", "calibrate", "accelerometer", "--yes", "--pause", 2)
    lines = result.out.splitlines()
    assert lines[0] == "Place the vehicle level, hold it still, and confirm."
    assert sum(line.startswith("Place the vehicle ") for line in lines) == 6
    assert lines[-1] == "vehicle 1: accelerometer calibration done; reboot the vehicle"


def test_steps_as_json(simulate, mav):
    simulate(PX4_COPTER)
    lines = [
        json.loads(line) for line in mav("vehicle", "calibrate", "accelerometer", "--json").out.splitlines()
    ]
    assert lines[0]["pending"][-1] == "level"
    assert lines[-1] == {
        "system": 1,
        "action": "calibrate",
        "kind": "accelerometer",
        "ok": True,
        "text": "accelerometer calibration done",
        "reboot_needed": False,
    }


def test_what_the_vehicle_lacks(simulate, mav):
    simulate(PX4_COPTER)
    result = mav("vehicle", "calibrate", "compass-motor")
    assert result.code == 1
    assert result.err.startswith("mav vehicle: vehicle 1/1 cannot run the compass-motor calibration: ")
    assert mav("vehicle", "calibrate", "--cancel").code == 2
    assert (
        mav("vehicle", "calibrate", "compass", "--cancel").out == "vehicle 1: compass calibration cancelled\n"
    )


def test_the_shell_asks_by_its_prompt(capsys):
    async def scenario(session, world):
        asked = []

        async def ask(question):
            asked.append(question)
            return ""

        session.ask = ask
        await run_line(session, "calibrate accelerometer")
        assert asked == ["[Enter] "] * 6

    in_shell(COPTER, scenario)
    out = capsys.readouterr().out
    assert "Place the vehicle on its left side, hold it still, and confirm.\n" in out
    assert "accelerometer calibration done" in out
