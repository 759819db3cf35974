"""`mav swarm show`: check, files and flight."""

from __future__ import annotations

import json

import pytest

from mavstack.swarm.shows.skyb import read_skyb
from tests.cli.harness import COPTER
from tests.swarm.shows.samples import csv_archive, skyc


@pytest.fixture
def show(tmp_path):
    path = tmp_path / "circle.skyc"
    path.write_bytes(skyc(4))
    return path


def test_a_sound_show_is_checked(mav, show):
    result = mav("swarm", "show", show, "--check", "--json")
    assert (result.code, result.err) == (0, "")
    report = json.loads(result.out)
    assert (report["name"], report["vehicles"], report["ok"]) == ("Circle", 4, True)
    assert report["separation_m"] == pytest.approx(21.2, abs=0.1)
    text = mav("swarm", "show", show, "--check").out
    assert "smallest separation  21.21 m" in text


def test_a_show_that_passes_a_limit_is_named(mav, tmp_path):
    path = tmp_path / "narrow.skyc"
    path.write_bytes(skyc(8, radius=5.0))
    result = mav("swarm", "show", path, "--check")
    assert result.code == 1
    assert "m apart at" in result.out
    assert mav("swarm", "show", path, "--check", "--position-error", 0.02, "--speed", 2).code == 0


def test_files_of_vehicles_are_written(mav, tmp_path):
    path = tmp_path / "show.zip"
    path.write_bytes(csv_archive(2))
    folder = tmp_path / "out"
    result = mav("swarm", "show", path, "--skyb", folder)
    assert (result.code, result.out) == (0, f"2 files in {folder}\n")
    assert read_skyb((folder / "0002.skyb").read_bytes()).trajectory.end == pytest.approx(20.0)


def test_a_vehicle_gets_its_file(simulate, mav, tmp_path):
    simulate(COPTER)
    path = tmp_path / "one.skyc"
    path.write_bytes(skyc(1))
    result = mav("swarm", "show", path, "--upload")
    assert (
        result.code == 1
    )  # the simulated firmware has no shows, and refuses the command that reads the file
    assert "uploading the show failed on 1 of 1 vehicles" in result.err


@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        (("missing.skyc", "--check"), 1, "missing.skyc"),
        ((__file__, "--check"), 1, "its columns are not"),
        (("missing.skyc", "--position-error", "-1"), 2, "is not a standard deviation"),
    ],
)
def test_wrong_files_and_usage_are_refused(mav, words, code, text):
    result = mav("swarm", "show", *words)
    assert result.code == code
    assert text in result.err
