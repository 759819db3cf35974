"""`mav vehicle servo`, `relay`, `roi` and others: what they do, ask and refuse; the same in the shell."""

from __future__ import annotations

import io
import json

import pytest

from tests.cli.harness import COPTER, PX4_COPTER


def test_ardupilots_outputs(simulate, mav):
    harness = simulate(COPTER)
    payload = harness.vehicle.autopilot.payload
    harness.vehicle.parameters.set("GRIP_ENABLE", 1)
    harness.vehicle.parameters.set("WINCH_TYPE", 1)
    for words, out in {
        ("servo", 9, 1900): "servo 9 at 1900 µs",
        ("relay", 1, "on"): "relay 1 on",
        ("gripper", "grip"): "gripper closed",
        ("winch", "unwind", 5): "unwound 5.0 m",
        ("ekf-source", 2): "estimator source set 2",
        ("roi", 47.3985, 8.546, 10): "pointing at 47.3985000 8.5460000",
        ("roi", "none"): "pointing ahead",
    }.items():
        result = mav("vehicle", *words)
        assert (result.code, result.out, result.err) == (0, f"vehicle 1: {out}\n", "")
    assert (payload.servos[9], payload.relays[1], payload.gripper_closed) == (1900, True, True)
    assert payload.winch == pytest.approx(5.0, abs=0.11)
    assert mav("vehicle", "winch", "unwind", -2, "--no-wait").out == "vehicle 1: unwinding -2.0 m\n"


def test_what_the_firmware_lacks_is_one_line(simulate, mav):
    simulate(PX4_COPTER)
    result = mav("vehicle", "servo", 1, 1500)
    assert result.code == 1
    text = "vehicle 1/1 cannot set a servo: PX4 numbers its outputs as actuators; use set_actuator"
    assert result.err == f"mav vehicle: {text}\n"
    assert mav("vehicle", "actuator", 1, "-0.5").code == 0


@pytest.mark.parametrize("words", [("terminate",), ("motor-test", "1")], ids=" ".join)
def test_dangerous_actions_need_a_yes(simulate, mav, monkeypatch, words):
    harness = simulate(COPTER)
    refused = mav("vehicle", *words)
    assert refused.code == 2
    assert "add --yes to" in refused.err

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.setattr("sys.stdin", Terminal("no\n"))
    declined = mav("vehicle", *words)
    assert (declined.code, declined.err) == (1, "nothing was sent\n")
    assert "? [y/N] " in declined.out
    assert harness.vehicle.autopilot.payload.motor_tested == 0


def test_a_confirmed_motor_test(simulate, mav):
    simulate(COPTER)
    result = mav("vehicle", "motor-test", 2, "--duration", 1, "--yes", "--json")
    assert json.loads(result.out) == {
        "system": 1,
        "action": "motor-test",
        "ok": True,
        "text": "motor 2 ran for 1 s",
    }


def test_a_place_that_is_none(simulate, mav):
    simulate(COPTER)
    assert mav("vehicle", "roi", "there").code == 2
    assert mav("vehicle", "winch", "unwind").code == 2
