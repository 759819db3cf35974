"""`mav rid` with a simulated vehicle and its module."""

from __future__ import annotations

import json

from mavstack.cli.main import main
from mavstack.sim import BackgroundSimulator


def mav(capsys, *words, code=0):
    assert main(list(words)) == code, capsys.readouterr().err
    return capsys.readouterr()


def with_module() -> BackgroundSimulator:
    simulator = BackgroundSimulator()
    simulator.vehicle.has_remote_id = True
    simulator.vehicle.reboot()
    return simulator


def test_without_a_module(capsys):
    with BackgroundSimulator() as simulator:
        text = mav(capsys, "rid", "status", "--url", simulator.url, "--for", "1", code=1).out
    assert text.splitlines()[:2] == [
        "the vehicle is not known to be ready (module none)",
        "  no Remote ID module was heard",
    ]


def test_reasons_and_then_readiness(capsys):
    with with_module() as simulator:
        text = mav(capsys, "rid", "status", "--url", simulator.url, code=1).out
        assert "the vehicle may not arm (module 236)\n  missing BasicID\n" in text
        words = ("--operator", "47.3977,8.5456,488", "--serial", "1596F3", "--operator-id", "FIN87")
        sent = mav(capsys, "rid", "send", *words, "--url", simulator.url, "--for", "2", "--json").out
        assert json.loads(sent)["sent"] >= 4
        found = json.loads(mav(capsys, "rid", "status", "--url", simulator.url, "--json", "--for", "2").out)
    assert (found["may_arm"], found["module"], found["reasons"]) == (True, 236, [])


def test_wrong_usage(capsys):
    assert "Earth" in mav(capsys, "rid", "send", "--operator", "99,8", code=2).err
    assert mav(capsys, "rid", "send", "--operator", "9", code=2).err
