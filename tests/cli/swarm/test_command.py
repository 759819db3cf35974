"""`mav swarm` on simulated vehicles, in virtual time."""

from __future__ import annotations

import json
import shlex

import pytest

from mavstack.cli.swarm.command import EXAMPLES
from mavstack.swarm.formations import FORMATIONS
from tests.cli.harness import COPTER, PX4_COPTER, examples_of
from tests.docs.blocks import BLOCKS
from tests.swarm.shows.samples import skyc

KINDS = (COPTER, PX4_COPTER, COPTER)
GUIDE = [
    shlex.split(line, comments=True)[1:]
    for block in BLOCKS
    if block.page == "guides/swarms.md" and block.language == "sh"
    for line in block.text.splitlines()
    if line.startswith("mav swarm")
]


def heights(harness):
    return [-each.body.truth.down for each in harness.simulation.vehicles]


def test_list_shows_the_formations(mav):
    assert json.loads(mav("swarm", "list", "--json").out) == dict(FORMATIONS)
    assert mav("swarm", "list").out.startswith("line       abeam of the leader")


@pytest.mark.flight
def test_a_formation_takes_off_and_reports_its_separation(simulate, mav):
    harness = simulate(*KINDS, apart=True)
    words = ("--spacing", 12, "--lead", 2, "--takeoff", "--altitude", 15, "--json")
    result = mav("swarm", "formation", "wedge", *words)
    assert (result.code, result.err) == (0, "")
    outcome = json.loads(result.out)
    assert (outcome["systems"], outcome["text"]) == ([2, 1, 3], "in formation wedge")
    assert outcome["smallest_separation_m"] > 5.0
    assert heights(harness) == pytest.approx([15.0] * 3, abs=1.0)
    stopped = mav("swarm", "stop")
    assert (stopped.code, stopped.out) == (0, "swarm of 1, 2, 3; 1 leads\nstopped\n")
    refused = mav("swarm", "formation", "line", "--spacing", 3)
    assert (refused.code, refused.out) == (1, "swarm of 1, 2, 3; 1 leads\n")
    assert refused.err.startswith("mav swarm: goals must be at least 6.8 m apart")
    low = mav("swarm", "formation", "text", "--text", "I", "--altitude", 8)
    assert low.code == 1
    assert "slots must be at least 2 m above the leader's home" in low.err
    assert mav("swarm", "land").code == 0
    assert mav("swarm", "stop").code == 0
    assert heights(harness) == pytest.approx([0.0] * 3, abs=0.2)


def test_vehicles_on_the_ground_and_a_wrong_leader_are_refused(simulate, mav):
    simulate(*KINDS, apart=True)
    refused = mav("swarm", "move", 10, 0)
    assert refused.code == 1
    assert "not armed" in refused.err
    wrong = mav("swarm", "move", 10, 0, "--lead", 9)
    assert wrong.code == 2
    assert wrong.err == "mav swarm: --lead 9 is not one of the vehicles 1, 2, 3\n"
    assert mav("swarm", "formation", "blob").code == 2


@pytest.mark.nightly
@pytest.mark.timeout(600)
@pytest.mark.parametrize("examples", [examples_of(EXAMPLES), GUIDE], ids=["help", "guide"])
def test_examples_run_one_after_the_other(simulate, mav, examples, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("show.skyc", "circle.skyc"):
        (tmp_path / name).write_bytes(skyc(len(KINDS) + 1))
    simulate(*KINDS, COPTER, apart=True)
    assert examples
    for words in examples:
        result = mav(*words)
        assert (result.code, result.err) == (0, ""), (words, result)
