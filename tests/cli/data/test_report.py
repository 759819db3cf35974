"""`mav data report` and `mav data plot`."""

from __future__ import annotations

import io
import json

import pytest

from mavstack.dialects import common
from tests.logs.files import encoded, stamped
from tests.logs.flights import flight_tlog


@pytest.fixture
def tlog(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "flight.tlog"
    path.write_bytes(flight_tlog())
    return path


def test_a_page_and_its_facts_beside_the_log(mav, tlog, tmp_path):
    result = mav("data", "report", tlog)
    assert (result.code, result.err) == (0, "")
    assert (
        result.out.splitlines()[-1]
        == f"report: {tmp_path / 'flight.html'} (facts: {tmp_path / 'flight.json'})"
    )
    assert (tmp_path / "flight.html").read_text("utf-8").startswith("<!doctype html>")
    data = json.loads((tmp_path / "flight.json").read_text("utf-8"))
    printed = json.loads(mav("data", "report", tlog, "--json").out)
    assert data == printed


def test_another_path_and_a_part_of_the_log(mav, tlog, tmp_path):
    result = mav("data", "report", tlog, "-o", "part.html", "--end", "5", "--system", "1")
    assert result.code == 0
    data = json.loads((tmp_path / "part.json").read_text("utf-8"))
    assert [vehicle["system"] for vehicle in data["vehicles"]] == [1]
    assert data["duration_s"] <= 5


def test_charts_on_the_terminal(mav, tlog, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    lines = mav("data", "plot", tlog, "altitude", "BATTERY_STATUS.voltages[0]").out.splitlines()
    assert lines[0] == "Altitude above home [m]"
    assert any(any(0x2800 < ord(letter) < 0x2900 for letter in line) for line in lines)
    assert all(len(line) <= 60 for line in lines)
    assert "BATTERY_STATUS.voltages[0] [V]: voltages[0]" in lines


@pytest.mark.parametrize(
    ("name", "start"), [("x.png", b"\x89PNG"), ("x.svg", b"<svg"), ("x.html", b"<!doctype")]
)
def test_charts_as_files(mav, tlog, tmp_path, name, start):
    assert mav("data", "plot", tlog, "attitude", "-o", name).code == 0
    assert (tmp_path / name).read_bytes().startswith(start)


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (("nonsense",), "neither a topic"),
        (("ATTITUDE",), "neither a topic"),
        (("attitude", "-o", "x.jpg"), "must be .png, .svg or .html"),
        (("vibration",), "holds none of vibration"),
        (("ATTITUDE.nothing",), "has no field nothing"),
    ],
)
def test_wrong_usage_is_reported_in_one_line(mav, tlog, words, problem):
    result = mav("data", "plot", tlog, *words)
    assert result.code in (1, 2)
    assert problem in result.err
    assert result.err.count("\n") == 1


def test_unknown_values_are_no_points(mav, tlog, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    result = mav("data", "plot", tlog, "ATTITUDE.pitch")  # NaN throughout
    assert (result.code, "it holds none of ATTITUDE.pitch" in result.err) == (1, True)
    messages = [common.Attitude(roll=roll) for roll in (0.5, float("nan"), 0.25)]
    tlog.write_bytes(stamped(encoded(messages), step=1_000_000))
    lines = mav("data", "plot", tlog, "ATTITUDE.roll").out.splitlines()
    assert (lines[1].split()[0], lines[8].split()[0]) == ("0.5", "0.25")


def test_a_constant_is_drawn_in_the_middle(mav, tlog, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    lines = mav("data", "plot", tlog, "BATTERY_STATUS.voltages[1]").out.splitlines()
    drawn = [any(0x2800 < ord(letter) < 0x2900 for letter in line) for line in lines[1:9]]
    assert (lines[1].split()[0], lines[8].split()[0]) == ("5.001", "3.001")
    assert drawn == [number == 4 for number in range(8)] or drawn == [number == 3 for number in range(8)]
    assert lines[9].split() == ["0.3", "s", "9.3", "s"]


def test_an_array_is_plotted_by_its_elements(mav, tlog):
    result = mav("data", "plot", tlog, "BATTERY_STATUS.voltages")
    assert (result.code, "BATTERY_STATUS.voltages[0]" in result.err) == (2, True)


def test_a_name_without_a_suffix_is_a_page(mav, tlog, tmp_path):
    result = mav("data", "report", tlog, "-o", "mine")
    assert result.code == 0
    assert "mine.html (facts: mine.json)" in result.out.replace(f"{tmp_path}/", "")
    assert sorted(path.name for path in tmp_path.glob("mine*")) == ["mine.html", "mine.json"]


def test_the_facts_never_replace_the_page(mav, tlog, tmp_path):
    result = mav("data", "report", tlog, "-o", "x.json")
    assert (result.code, "name the page" in result.err) == (2, True)
    assert not (tmp_path / "x.json").exists()


def test_files_that_the_user_did_not_name_are_kept(mav, tlog, tmp_path):
    facts, page = tmp_path / "flight.json", tmp_path / "flight.html"
    facts.write_text('{"my": "notes"}')
    refused = mav("data", "report", tlog)
    assert (refused.code, page.exists(), facts.read_text()) == (1, False, '{"my": "notes"}')
    assert f"cannot write {facts}: it exists and is of no earlier report" in refused.err
    assert mav("data", "report", tlog, "-o", page).code == 1
    assert mav("data", "report", tlog, "--force").code == 0
    assert json.loads(facts.read_text("utf-8"))["kind"] == "mavstack flight report"
    assert mav("data", "report", tlog).code == 0, "files of an earlier report are replaced"
    page.write_text("<h1>Mine</h1>")
    assert mav("data", "report", tlog).code == 1
    assert mav("data", "report", tlog, "-o", page).code == 0, "the user named it"


def test_the_report_of_another_log_beside_this_one_is_kept(mav, tlog, tmp_path):
    other = tmp_path / "flight.bin"
    other.write_bytes(tlog.read_bytes())
    assert mav("data", "report", tlog).code == 0
    before = (tmp_path / "flight.json").read_text("utf-8")
    assert mav("data", "report", other).code == 1
    assert (tmp_path / "flight.json").read_text("utf-8") == before


@pytest.mark.parametrize(("answer", "code"), [("y\n", 0), ("n\n", 1), ("", 1)])
def test_a_terminal_is_asked_before_a_file_is_replaced(mav, tlog, tmp_path, monkeypatch, answer, code):
    facts = tmp_path / "flight.json"
    facts.write_text('{"my": "notes"}')
    terminal = io.StringIO(answer)
    monkeypatch.setattr(terminal, "isatty", lambda: True)
    monkeypatch.setattr("sys.stdin", terminal)
    result = mav("data", "report", tlog)
    assert (result.code, facts.read_text("utf-8") == '{"my": "notes"}') == (code, code == 1)
    assert "replace it? [y/N]" in result.out + result.err
