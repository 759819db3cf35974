from __future__ import annotations

import json
import random
import sys
from types import SimpleNamespace

import pytest

from mavstack.cli.ftp.paths import RemotePath
from mavstack.cli.log.command import EXAMPLES, _ranges
from mavstack.cli.log.files import local_file_name, match_files, time_text
from mavstack.services.ftp import Entry
from mavstack.services.log import LogEntry
from mavstack.sim.vehicle_types import VehicleType
from tests.cli.harness import CliHarness, examples_of

TIME = 1_795_255_200  # 2026-11-21 10:00:00 UTC
PATHS = {
    "ardupilot": ["/APM/LOGS/00000001.BIN", "/APM/LOGS/00000002.BIN"],
    "px4": ["/fs/microsd/log/2026-11-21/10_00_00.ulg", "/fs/microsd/log/2026-11-21/11_00_00.ulg"],
}


def random_bytes(size, seed=1):
    return random.Random(seed).randbytes(size)


@pytest.fixture
def harness(monkeypatch, tmp_path):
    return filled(monkeypatch, tmp_path)


def filled(monkeypatch, tmp_path, firmware="ardupilot", sizes=(90_000, 2000)):
    monkeypatch.chdir(tmp_path)
    harness = CliHarness(monkeypatch, (VehicleType.COPTER, firmware))
    for path, size in zip(PATHS[firmware], sizes, strict=True):
        harness.put(path, random_bytes(size, size))
    return harness


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_examples_of_the_help_run(mav, monkeypatch, tmp_path, firmware):
    filled(monkeypatch, tmp_path, firmware)
    for words in examples_of(EXAMPLES):
        result = mav(*words)
        if "stream" in words and firmware == "ardupilot":
            assert result.code == 1
            assert "UNSUPPORTED" in result.err
            continue
        assert (result.code, result.err) == (0, ""), words
        assert result.out
    names = {
        "ardupilot": ["00000001.BIN", "00000002.BIN"],
        "px4": ["log_0_2026-11-21_10-00-00.ulg", "log_1_2026-11-21_11-00-00.ulg"],
    }[firmware]
    assert sorted(path.name for path in (tmp_path / "logs").iterdir()) == names
    assert [(tmp_path / "logs" / name).read_bytes() for name in names] == [
        random_bytes(90_000, 90_000),
        random_bytes(2000, 2000),
    ]
    assert (tmp_path / names[1]).read_bytes() == random_bytes(2000, 2000)
    assert mav("log", "list").err == "there are no logs\n"


def test_help_shows_the_examples_of_each_action(mav):
    for action in ("list", "get", "erase"):
        assert f"  mav log {action}" in mav("log", action, "--help").out


def test_list(mav, monkeypatch, tmp_path):
    filled(monkeypatch, tmp_path, "px4")
    assert mav("log", "list").out == "0  2026-11-21 10:00:00  90.0 kB\n1  2026-11-21 11:00:00   2.0 kB\n"
    assert json.loads(mav("log", "list", "--json").out) == [
        {"id": 0, "time_utc": TIME, "size": 90_000},
        {"id": 1, "time_utc": TIME + 3600, "size": 2000},
    ]


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize(("via", "way"), [("auto", "ftp"), ("ftp", "ftp"), ("log", "log")])
def test_download_path_is_selected(mav, harness, tmp_path, via, way):
    printed = json.loads(mav("log", "get", "1", "-o", "x.BIN", "--via", via, "--json").out)
    assert printed == {"id": 1, "file": "x.BIN", "size": 90_000, "via": way}
    assert (tmp_path / "x.BIN").read_bytes() == random_bytes(90_000, 90_000)


def test_logs_of_equal_size_are_downloaded_by_number(mav, monkeypatch, tmp_path):
    filled(monkeypatch, tmp_path, sizes=(3000, 3000))
    assert json.loads(mav("log", "get", "2", "--json").out)["via"] == "log"
    result = mav("log", "get", "1", "--via", "ftp")
    assert result.code == 1
    assert result.err == "mav log: the file of log 1 is not known; download the log with --via log\n"


def test_without_ftp_logs_are_downloaded_by_number(mav, harness, monkeypatch, tmp_path):
    def refused(path):
        raise PermissionError

    monkeypatch.setattr(harness.vehicle.storage.files, "list_directory", refused)
    assert json.loads(mav("log", "get", "last", "--json").out) == {
        "id": 2,
        "file": "00000002.BIN",
        "size": 2000,
        "via": "log",
    }


def test_a_downloaded_log_is_kept(mav, harness, tmp_path):
    assert mav("log", "get", "2").code == 0
    assert mav("log", "get", "2").out == "log 2 -> 00000002.BIN (already downloaded)\n"
    (tmp_path / "00000001.BIN").write_bytes(b"mine")
    result = mav("log", "get", "all")
    assert result.code == 1
    assert result.err == "mav log: 00000001.BIN exists with another size; move it away, or add --force\n"
    assert "log 2" in result.out
    assert (tmp_path / "00000001.BIN").read_bytes() == b"mine"
    assert mav("log", "get", "1", "--force").code == 0
    assert (tmp_path / "00000001.BIN").read_bytes() == random_bytes(90_000, 90_000)


@pytest.mark.parametrize(
    "words", [["get"], ["get", "first"], ["get", "-1"], ["get", "70000"], ["erase"], ["dance"]]
)
def test_wrong_usage(mav, harness, monkeypatch, words):
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(isatty=lambda: False))
    result = mav("log", *words)
    assert (result.code, result.out) == (2, "")
    assert result.err


def test_unknown_log_number(mav, harness):
    result = mav("log", "get", "7")
    assert (result.code, result.err) == (1, "mav log: there is no log 7; there are 1-2\n")
    assert _ranges([1, 2, 3, 7, 9, 10]) == "1-3, 7, 9-10"


@pytest.mark.parametrize(("answer", "left", "code"), [("y\n", 0, 0), ("n\n", 2, 1), ("", 2, 1), ("\n", 2, 1)])
def test_erase_asks_on_a_terminal(mav, harness, monkeypatch, answer, left, code):
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(isatty=lambda: True, readline=lambda: answer))
    result = mav("log", "erase")
    assert result.code == code
    assert result.out.startswith("erase all 2 logs (92.0 kB) of vehicle 1? [y/N] ")
    assert len(json.loads(mav("log", "list", "--json").out)) == left


@pytest.mark.flight
def test_vehicle_falls_silent(mav, harness, tmp_path):
    store = harness.vehicle.storage.files
    opened = store.open_file

    def cut(path, **options):
        harness.vehicle.cut(True)
        return opened(path, **options)

    store.open_file = cut
    result = mav("log", "get", "1")
    assert (result.code, result.out) == (1, "")
    assert result.err.startswith("mav log: downloading /APM/LOGS/00000001.BIN from 1/1 failed")
    assert result.err.count("\n") == 1
    assert not (tmp_path / "00000001.BIN").exists()


def test_local_names_and_times():
    dated, undated = LogEntry(12, TIME, 5), LogEntry(3, 0, 5)
    assert local_file_name(dated, ".BIN") == "00000012.BIN"
    assert local_file_name(dated, ".ulg") == "log_12_2026-11-21_10-00-00.ulg"
    assert local_file_name(undated, ".ulg") == "log_3.ulg"
    assert (time_text(dated), time_text(undated)) == ("2026-11-21 10:00:00", "")


def test_files_of_equal_size_are_not_matched():
    files = [
        RemotePath(f"/{name}", Entry(name, size=size))
        for name, size in (("a", 1), ("b", 1), ("c", 2), ("d", 0))
    ]
    logs = [LogEntry(1, 0, 1), LogEntry(2, 0, 2), LogEntry(3, 0, 0), LogEntry(4, 0, 9)]
    assert {number: found.path for number, found in match_files(logs, files).items()} == {2: "/c"}
    assert match_files([LogEntry(1, 0, 2), LogEntry(2, 0, 2)], files) == {}


def test_a_log_larger_than_the_limit_is_not_downloaded(mav, harness, tmp_path):
    result = mav("log", "get", "1", "--max-size", "20k")
    assert result.code == 1
    assert result.err == "mav log: log 1 has 90.0 kB, more than the 20.0 kB allowed; --max-size allows more\n"
    assert list(tmp_path.iterdir()) == []
    assert mav("log", "get", "1", "--max-size", "90k").code == 0


@pytest.mark.parametrize("via", ["log", "ftp"])
def test_a_log_that_takes_too_long_ends_with_the_option_that_allows_it(mav, harness, via):
    result = mav("log", "get", "1", "--via", via, "--action-timeout", 0.3)
    assert result.code == 1
    assert "--action-timeout allows more time" in result.err
