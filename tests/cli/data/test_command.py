"""`mav data`: facts, tables, conversion and queries of logs from the command line."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest

from mavstack.cli.data.command import EXAMPLES
from tests.docs.blocks import BLOCKS
from tests.logs.flights import flight_tlog


@pytest.fixture
def tlog(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "flight.tlog"
    path.write_bytes(flight_tlog())
    return path


def test_info(mav, tlog):
    facts = json.loads(mav("data", "info", tlog, "--json").out)
    assert (facts["packets"], facts["format"], facts["bad_bytes"]) == (100, "tlog", 0)
    assert facts["messages"]["HEARTBEAT"] == 30
    assert facts["sources"] == ["1/1", "2/1", "255/190"]
    assert facts["duration_s"] == pytest.approx(9.9)
    assert facts["start"] == "2023-11-14T22:13:20.000000Z"
    assert facts["info"]["vehicle_type"] == "QUADROTOR"
    text = mav("data", "info", tlog).out
    assert "100 in 7 messages" in text
    assert "nothing skipped" in text
    assert "second 9" in text


def test_damage_is_reported_and_fails_with_strict(mav, tlog):
    tlog.write_bytes(tlog.read_bytes() + b"junk" * 5)
    assert mav("data", "info", tlog).code == 0
    assert mav("data", "info", tlog, "--strict", "--json").code == 1
    result = mav("data", "messages", tlog, "--strict")
    assert (result.code, result.err) == (1, f"mav data: {tlog}: skipped 20 bad bytes\n")
    result = mav("data", "convert", tlog, "--to", "kml", "--strict")
    assert (result.code, "skipped 20 bad bytes" in result.err) == (1, True)


def test_messages(mav, tlog):
    lines = mav("data", "messages", tlog).out.splitlines()
    assert lines[0].split() == ["MESSAGE", "ROWS", "HZ"]
    assert lines[1].split() == ["ATTITUDE", "10", "1.01"]
    columns = mav("data", "messages", tlog, "GLOBAL_POSITION_INT").out
    assert "degE7" in columns or "deg" in columns
    schema = json.loads(mav("data", "messages", tlog, "HEARTBEAT", "--json").out)
    assert schema["name"] == "HEARTBEAT"
    result = mav("data", "messages", tlog, "NOTHING")
    assert (result.code, "contains no NOTHING" in result.err) == (1, True)


def test_convert_one_log(mav, tlog, tmp_path):
    result = mav("data", "convert", tlog, "--to", "kml")
    assert (result.code, result.err) == (0, "")
    assert result.out == f"{tlog}: 20 points of 2 vehicles -> {tmp_path / 'flight.kml'}\n"
    assert mav("data", "convert", tlog, "--to", "parquet", "-o", "set").code == 0
    assert list((tmp_path / "set").rglob("*ATTITUDE*/*.parquet"))
    assert mav("data", "convert", tlog, "--to", "csv", "--only", "ATTITUDE", "--end", "4.5").code == 0
    assert len((tmp_path / "flight-csv" / "ATTITUDE.csv").read_text().splitlines()) == 6


@pytest.mark.flight
def test_convert_several_logs_in_processes(mav, tlog, tmp_path):
    for name in ("b.tlog", "c.tlog"):
        (tmp_path / name).write_bytes(tlog.read_bytes())
    (tmp_path / "bad.tlog").write_bytes(b"%PDF-1.7 not a log")
    result = mav(
        "data", "convert", tlog, "b.tlog", "bad.tlog", "c.tlog", "--to", "geojson", "-o", "out", "--json"
    )
    assert result.code == 1
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "b.geojson",
        "c.geojson",
        "flight.geojson",
    ]
    problems = {json.loads(line)["file"]: json.loads(line)["problem"] for line in result.out.splitlines()}
    assert "bad.tlog: there is nothing to write" in problems["bad.tlog"]
    assert problems["b.tlog"] == ""


def test_query(mav, tlog):
    result = mav("data", "query", tlog, "ATTITUDE.roll where armed")
    lines = result.out.splitlines()
    assert (result.code, lines[0], len(lines)) == (0, "_time,roll", 7)
    rows = mav("data", "query", tlog, "SELECT max(alt) / 1000 AS top FROM GLOBAL_POSITION_INT", "--json").out
    assert json.loads(rows) == {"top": 497.0}
    missing = mav("data", "query", tlog, "SELECT pitch FROM ATTITUDE LIMIT 1", "--json").out
    assert json.loads(missing) == {"pitch": None}
    wrong = mav("data", "query", tlog, "SELECT x FROM ATTITUDE")
    assert (wrong.code, wrong.err.count("\n")) == (1, 1)


def test_a_result_on_a_terminal_is_a_table(mav, tlog, monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setattr("mavstack.cli.data.query._MAX_SHOWN", 3)
    result = mav("data", "query", tlog, "SELECT roll, text FROM ATTITUDE, STATUSTEXT")
    assert "roll" in result.out.splitlines()[0]
    assert len(result.out.splitlines()) == 4
    assert "97 more rows" in result.err


@pytest.mark.parametrize(
    "words",
    [
        ("info", "missing.tlog"),
        ("convert", "missing.tlog", "--to", "kml"),
        ("query", "missing.tlog", "ATTITUDE.roll"),
        ("info", "flight.tlog", "--format", "nonsense"),
    ],
)
def test_failures_are_one_line(mav, tlog, words):
    result = mav("data", *words)
    assert result.code == 1
    assert result.err.startswith("mav data: ")
    assert result.err.count("\n") == 1


def matches(word: str) -> list[str]:
    """Return the files that a word of a shell stands for."""
    return sorted(map(str, Path().glob(word))) if "*." in word else [word]


#: Examples that need other machines.
ELSEWHERE = "s3://"
LINES = [
    line.strip() for line in EXAMPLES.splitlines() if line.startswith("  mav ") and ELSEWHERE not in line
]


@pytest.mark.fast_cases(4)
@pytest.mark.parametrize("line", LINES)
def test_examples_of_the_help_run(mav, tlog, tmp_path, line):
    (tmp_path / "logs" / "2026").mkdir(parents=True)
    names = ("before.tlog", "after.tlog", "damaged.tlog", "00000042.BIN", "logs/a.tlog", "logs/b.tlog")
    for name in (*names, "capture.pcap", "logs/c.BIN", "logs/2026/flight.tlog"):
        (tmp_path / name).write_bytes(tlog.read_bytes())
    Path("bench.json").write_text(next(each.text for each in BLOCKS if each.directive == "decoder"), "utf-8")
    if "decode" in line:
        Path("capture.bin").write_bytes(bytes.fromhex("aa55040106ff01c04f"))
    words = shlex.split(line.partition(" | ")[0], comments=True)[1:]
    result = mav(*(found for word in words for found in matches(word)))
    # The recordings of this test have no vibration and no power.
    assert result.code == 0 or "holds none of" in result.err or "neither a topic" in result.err, result.err


STRICT = {
    "info": ("info", "FILE"),
    "info as JSON": ("info", "FILE", "--json"),
    "messages": ("messages", "FILE"),
    "columns": ("messages", "FILE", "ATTITUDE"),
    "columns as JSON": ("messages", "FILE", "ATTITUDE", "--json"),
    "convert": ("convert", "FILE", "--to", "kml", "-o", "x.kml"),
    "query": ("query", "FILE", "ATTITUDE.roll"),
    "report": ("report", "FILE", "-o", "x.html"),
    "report as JSON": ("report", "FILE", "--json"),
    "plot": ("plot", "FILE", "altitude"),
    "diff": ("diff", "FILE", "sound.tlog"),
    "diff, second file": ("diff", "sound.tlog", "FILE"),
    "merge": ("merge", "sound.tlog", "FILE"),
    "repair": ("repair", "FILE", "-o", "new.tlog"),
    "replay": ("replay", "FILE", "--to", "udpout://127.0.0.1:9", "--speed", "max"),
}


@pytest.mark.parametrize("words", STRICT.values(), ids=STRICT)
@pytest.mark.parametrize("damage", ["junk", "damaged packet", "cut off"])
def test_every_action_fails_with_strict_if_anything_was_skipped(mav, tlog, words, damage):
    data = tlog.read_bytes()
    Path("sound.tlog").write_bytes(data)
    tlog.write_bytes(
        {
            "junk": data + b"junk" * 5,
            "damaged packet": data[:-5] + bytes([data[-5] ^ 1]) + data[-4:],
            "cut off": data[:-3],
        }[damage]
    )
    result = mav("data", *(str(tlog) if word == "FILE" else word for word in words), "--strict")
    assert result.code == 1
    assert "skipped" in result.err or "dropped" in result.out
