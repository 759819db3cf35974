"""`mav terrain` with a simulated vehicle."""

from __future__ import annotations

import json

import pytest

from mavstack.cli.main import main
from mavstack.cli.terrain.command import EXAMPLES
from mavstack.services.terrain import TerrainMap
from tests.cli.harness import CliHarness, examples_of

HERE = ("47.3977", "8.5456")


@pytest.fixture
def harness(monkeypatch):
    return CliHarness(monkeypatch)


def mav(capsys, *words, code=0):
    """Run a command, and return its output."""
    assert main(list(words)) == code, capsys.readouterr().err
    return capsys.readouterr()


def test_a_vehicle_that_knows_the_flat_ground(harness, capsys):
    text = mav(capsys, "terrain", "check", *HERE).out
    assert text.startswith("terrain 488.0 m above the sea, vehicle ")
    assert "504 tiles loaded, 0 pending" in text
    state = json.loads(mav(capsys, "terrain", "check", *HERE, "--json").out)
    assert (state["system"], state["spacing"], state["terrain_height"]) == (1, 100, 488.0)


def test_terrain_is_served(harness, capsys):
    harness.vehicle.terrain = TerrainMap()
    harness.vehicle.reboot()
    lacking = mav(capsys, "terrain", "check", *HERE, code=1).out
    assert "the vehicle lacks the terrain there; 0 tiles loaded, 56 pending" in lacking
    served = mav(capsys, "terrain", "serve", "--height", "510", "--for", "60").out
    assert served.startswith("serving 510 m on ")
    assert " tiles sent, 0 not known" in served
    assert mav(capsys, "terrain", "check", *HERE, "--wait").out.startswith("terrain 510.0 m above the sea, ")
    for words in examples_of(EXAMPLES):
        if not {"--hgt", "--tiles"} & set(words):
            mav(capsys, *words[1:] if words[0] == "mav" else words)
    counts = json.loads(mav(capsys, "terrain", "serve", "--height", "0", "--for", "2", "--json").out)
    assert counts["unknown"] == 0


def test_wrong_folders(capsys, tmp_path):
    missing = mav(capsys, "terrain", "serve", "--hgt", str(tmp_path / "no"), code=1).err
    assert missing == f"mav terrain: cannot open {tmp_path / 'no'}: No such file or directory\n"
    empty = mav(capsys, "terrain", "serve", "--hgt", str(tmp_path), code=1).err
    assert "has no .hgt files" in empty
