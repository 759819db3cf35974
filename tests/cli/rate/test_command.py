"""`mav rate`: shown, set, and refused."""

from __future__ import annotations

import json
import shlex

import pytest

from mavstack.cli.rate.command import EXAMPLES
from tests.cli.harness import COPTER, PX4_COPTER, examples_of
from tests.cli.shell.shell_session import type_lines


@pytest.mark.parametrize("kind", [COPTER, PX4_COPTER], ids=["ArduPilot", "PX4"])
def test_a_rate_is_set_and_shown(mav, simulate, kind):
    simulate(kind, ready=False)
    result = mav("rate", "attitude", "20")
    assert (result.code, result.out, result.err) == (0, "ATTITUDE: 20 Hz\n", "")
    assert mav("rate", "ATTITUDE", "off").out == "ATTITUDE: off\n"
    result = mav("rate", "30", "default", "--json")
    assert json.loads(result.out) == {"system": 1, "message": "ATTITUDE", "rate_hz": None}


def test_the_present_rate_is_shown(mav, simulate):
    simulate(ready=False)
    shown = json.loads(mav("rate", "HEARTBEAT", "--json").out)
    assert shown["message"] == "HEARTBEAT"


@pytest.mark.parametrize(
    "words", [("ATTITUDE", "x"), ("ATTITUDE", "-5"), ("ATITUDE", "5"), ("ATTITUDE", "nan")]
)
def test_wrong_usage(mav, words):
    assert mav("rate", *words).code == 2


def test_the_examples_run(mav, simulate):
    simulate(COPTER, COPTER, ready=False)
    for words in examples_of(EXAMPLES):
        selection = [] if {"--system", "--all"} & set(words) else ["--system", "1"]
        assert mav(*words, *selection).code == 0, shlex.join(words)


def test_a_rate_in_the_shell(capsys):
    type_lines("rate ATTITUDE 20")
    assert capsys.readouterr().out.endswith("ATTITUDE: 20 Hz\n")
