"""`mav log stream` writes a valid log, and never over another file."""

from __future__ import annotations

import json

from mavstack import open_log
from mavstack.sim.vehicle_types import VehicleType
from tests.cli.harness import CliHarness


def test_a_stream_is_written(mav, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    CliHarness(monkeypatch, (VehicleType.COPTER, "px4"))
    result = mav("log", "stream", "-o", "a.ulg", "--for", "15", "--json")
    assert (result.code, result.err) == (0, "")
    found = json.loads(result.out)
    path = tmp_path / "a.ulg"
    assert (found["size"], found["lost"]) == (path.stat().st_size, 0)
    assert len(open_log(path)["vehicle_attitude"]) > 10
    before = path.read_bytes()
    refused = mav("log", "stream", "-o", "a.ulg")
    assert refused.code == 1
    assert "add --force" in refused.err
    assert path.read_bytes() == before
