"""`mav simulator`."""

from __future__ import annotations

import json

import pytest

from mavstack.cli.main import main
from mavstack.simulators.faults import FAULTS
from mavstack.simulators.physics import PHYSICS


def test_list(capsys):
    assert main(["simulator", "list"]) == 0
    shown = capsys.readouterr().out
    assert all(entry.example in shown for entry in PHYSICS.values())
    assert all(fault in shown for fault in FAULTS)
    main(["simulator", "list", "--json"])
    assert set(json.loads(capsys.readouterr().out)["physics"]) == set(PHYSICS)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["px4", "--listen", "tcpin://127.0.0.1:0"], "ready: PX4 connects to TCP port "),
        (["ardupilot", "--listen", "udpin://127.0.0.1:0"], "ready: ArduPilot asks UDP port "),
    ],
)
def test_one_line_when_it_is_ready(words, line, capsys):
    assert main(["simulator", *words, "--for", "0.05", "--fault", "gps-lost"]) == 0
    assert capsys.readouterr().out.startswith(line)
    assert main(["simulator", *words, "--for", "0.05", "--json", "--physics", "plane"]) == 0
    assert json.loads(capsys.readouterr().out)["physics"] == "plane"


def test_a_wrong_physics_is_one_line(capsys):
    assert main(["simulator", "px4", "--physics", "zeppelin"]) != 0
    assert "there is no physics 'zeppelin'" in capsys.readouterr().err
