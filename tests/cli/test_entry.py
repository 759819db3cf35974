"""The start and the end of the process of `mav`."""

from __future__ import annotations

import subprocess
import sys

import pytest

from mavstack.cli import entry
from tests.logs.flights import flight_tlog


@pytest.mark.parametrize("loaded", [False, True])
def test_objects_are_not_collected_at_exit_unless_duckdb_counts_them(monkeypatch, loaded):
    calls = []
    monkeypatch.setattr("gc.freeze", lambda: calls.append("freeze"))
    monkeypatch.setattr("mavstack.cli.main.main", lambda: 3)
    monkeypatch.delitem(sys.modules, "duckdb", raising=False)
    if loaded:
        monkeypatch.setitem(sys.modules, "duckdb", sys)
    assert (entry.main(), calls) == (3, [] if loaded else ["freeze"])


@pytest.mark.flight
def test_a_query_prints_no_leaks_at_exit(tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(flight_tlog())
    words = ["data", "query", str(path), "SELECT count(*) FROM ATTITUDE"]
    result = subprocess.run([sys.executable, "-m", "mavstack", *words], capture_output=True, check=False)
    assert (result.returncode, result.stderr) == (0, b"")
