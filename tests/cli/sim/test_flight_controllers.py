from __future__ import annotations

import json

import pytest

NOWHERE = "msp+udpout://127.0.0.1:9"


def run(mav, *words: str):
    return mav("sim", *words, "--for", "0.5", "--speed", "max")


@pytest.mark.parametrize("firmware", ["betaflight", "inav"])
def test_a_flight_controller(mav, firmware):
    result = run(mav, "--firmware", firmware, "--out", NOWHERE)
    assert (result.code, result.err) == (0, "")
    assert result.out.splitlines()[:2] == [f"system 1: {firmware} copter", f"on {NOWHERE}"]


def test_several_have_a_link_each(mav):
    result = run(mav, "--firmware", "betaflight,inav", "--count", "3", "--out", NOWHERE, "--json")
    ready = json.loads(result.out.splitlines()[0])
    assert [each["firmware"] for each in ready["vehicles"]] == ["betaflight", "inav", "betaflight"]
    assert ready["links"] == [f"msp+udpout://127.0.0.1:{port}" for port in (9, 10, 11)]


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--firmware", "betaflight,px4"], "speak MSP"),
        (["--firmware", "inav", "--type", "plane"], "fly copters only"),
        (["--firmware", "inav", "--camera"], "--camera cannot be used with --firmware inav"),
        (["--firmware", "inav", "--out", "tcpin://127.0.0.1:0"], "write msp+tcpin://127.0.0.1:0"),
        (["--firmware", "cleanflight"], "the choices are ardupilot, px4, betaflight, inav"),
    ],
)
def test_what_does_not_fit_is_refused(mav, words, text):
    result = run(mav, *words)
    assert result.code == 2
    assert text in result.err
