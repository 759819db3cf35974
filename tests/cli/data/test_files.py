"""`mav data diff`, `repair`, `replay` and `book`."""

from __future__ import annotations

import json

import pytest

from mavstack import open_log
from tests.cli.watch.test_observation import receiver
from tests.logs.flights import flight_tlog


@pytest.fixture
def tlog(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "flight.tlog"
    path.write_bytes(flight_tlog())
    return path


def test_diff(mav, tlog):
    result = mav("data", "diff", tlog, tlog)
    assert (result.code, result.out) == (0, "parameters: no difference\nmission: no difference\n")
    assert json.loads(mav("data", "diff", tlog, tlog, "--json").out) == {"parameters": [], "mission": []}
    assert mav("data", "diff", tlog).code == 2
    assert mav("data", "diff", tlog, tlog, "--system", "2").code == 0
    assert mav("data", "diff", tlog, tlog, "--system", "300").code == 2


def test_merge(mav, tlog, tmp_path):
    (tmp_path / "other.tlog").write_bytes(tlog.read_bytes())
    result = mav("data", "merge", tlog, "other.tlog", "--to", "geojson", "-o", "both.geojson")
    assert (result.code, result.err) == (0, "")
    assert result.out.splitlines()[-1].endswith("points of 2 vehicles -> both.geojson")
    offsets = json.loads(mav("data", "merge", tlog, "other.tlog", "--json").out)["offsets"]
    assert len(offsets) == 2
    assert mav("data", "merge", tlog).code == 2
    assert mav("data", "merge", tlog, "other.tlog", "--to", "csv").code == 2


def test_repair(mav, tlog, tmp_path):
    tlog.write_bytes(tlog.read_bytes() + b"junk")
    result = mav("data", "repair", tlog, "-o", "new.tlog")
    assert (result.code, result.out) == (0, "new.tlog: 100 packets (3.5 kB), 4 bytes dropped (4 bad bytes)\n")
    assert open_log(tmp_path / "new.tlog").statistics.packets == 100
    again = mav("data", "repair", tlog, "-o", "new.tlog")
    assert (again.code, "never overwrites" in again.err) == (1, True)
    strict = mav("data", "repair", tlog, "-o", "other.tlog", "--strict", "--json")
    assert (strict.code, json.loads(strict.out)["dropped_bytes"]) == (1, 4)


def test_replay(mav, tlog):
    with receiver() as (url, received):
        result = mav("data", "replay", tlog, "--to", url, "--speed", "max", "--system", "1")
        packets = received()
    assert result.code == 0
    assert len(packets) == 70


def test_book(mav, tlog, tmp_path):
    result = mav("data", "book", tmp_path, "--csv", "book.csv", "--incident", "flight.tlog", "a remark")
    assert result.code == 0
    assert "2 flights; logs: 1 read, 0 unchanged, 0 removed, 0 failed" in result.err
    assert "a remark" in result.out
    assert (tmp_path / "flights.duckdb").exists()
    assert len((tmp_path / "book.csv").read_text().splitlines()) == 3
    rows = [json.loads(line) for line in mav("data", "book", tmp_path, "--json").out.splitlines()]
    assert [row["date"] for row in rows] == ["2023-11-14"] * 2
    assert mav("data", "book", tmp_path, "--strict").code == 0
    tlog.write_bytes(flight_tlog() + b"junk")
    damaged = mav("data", "book", tmp_path, "--strict")
    assert (damaged.code, "flight.tlog: skipped 4 bad bytes" in damaged.err) == (1, True)
    assert mav("data", "book", tmp_path, "--strict").code == 1, "unchanged, and damaged as before"
    assert mav("data", "book", tmp_path, "--incident", "none.tlog", "x").code == 2
    assert mav("data", "book", tmp_path / "nowhere", "-o", "b.duckdb").code == 1
    (tmp_path / "letter.tlog").write_bytes(b"no packets here")
    assert f"mav data: {tmp_path / 'letter.tlog'} contains no records\n" in mav("data", "book", tmp_path).err
