"""`mav msp get` and `set` against a small flight controller, in virtual time."""

from __future__ import annotations

import json

import pytest

from mavstack.cli.main import main
from tests.bridges.msp.controllers import IDENTITY

DEVICE = "/dev/ttyACM9"
PID, SET_PID, TUNING, SAVE = 112, 202, 111, 250


@pytest.fixture
def gains(firmware):
    """The gains of a firmware that keeps those which it is sent."""
    gains = [bytes(range(40, 55))]

    def keep(payload):
        gains.append(payload)
        return b""

    firmware.replies = {**IDENTITY, PID: lambda _: gains[-1], SET_PID: keep, TUNING: bytes(23), SAVE: b""}
    return gains


def test_names_and_patterns(gains, capsys):
    assert main(["msp", "get", DEVICE, "bf_pid_roll_p", "BF_THR_LIM_TYPE"]) == 0
    rows = [line.split("  ", 1) for line in capsys.readouterr().out.splitlines()]
    assert [row[0] for row in rows] == ["BF_PID_ROLL_P", "BF_THR_LIM_TYPE"]
    assert rows[0][1].split()[0] == "40"
    assert rows[1][1].split()[:2] == ["0", "off"]
    assert main(["msp", "get", DEVICE, "bf_pid_roll_?", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document == {"BF_PID_ROLL_P": 40, "BF_PID_ROLL_I": 41, "BF_PID_ROLL_D": 42}
    assert main(["msp", "get", DEVICE, "BF_NOPE*"]) == 1
    assert "there is no setting BF_NOPE*" in capsys.readouterr().err
    assert main(["msp", "get", DEVICE, "BF_NOPE"]) == 1


def test_values_are_written_and_read_back(firmware, gains, capsys):
    assert main(["msp", "set", DEVICE, "BF_PID_ROLL_P=50", "bf_pid_roll_d=42"]) == 0
    out, err = capsys.readouterr()
    assert out == "BF_PID_ROLL_P: 40 → 50\n"
    assert err.startswith("not saved")
    assert gains[-1][:3] == bytes([50, 41, 42])
    assert SAVE not in [frame.command for frame in firmware.received]
    assert main(["msp", "set", DEVICE, "BF_PID_ROLL_P=0x20", "--save", "--json"]) == 0
    assert capsys.readouterr() == ('{"BF_PID_ROLL_P": 32}\n', "")
    assert firmware.received[-1].command == SAVE


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["BF_PID_ROLL_P"], 2),
        (["BF_PID_ROLL_P=1", "bf_pid_roll_p=2"], 2),
        (["BF_PID_ROLL_P=x"], 2),
        (["BF_THR_LIM_TYPE=nosuch"], 2),
        (["BF_PID_ROLL_P=50", "BF_PID_ROLL_I=500"], 1),
        (["BF_NOPE=1"], 1),
    ],
)
def test_nothing_is_written_if_a_word_is_wrong(gains, capsys, words, code):
    assert main(["msp", "set", DEVICE, *words]) == code
    assert capsys.readouterr().err.startswith("mav msp")
    assert len(gains) == 1
