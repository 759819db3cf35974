"""`mav record`: links to files."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import sys
import time
from random import Random

import pytest

from mavstack import open_log
from mavstack.cli.record.command import EXAMPLES
from mavstack.cli.registry import command_parser
from mavstack.dialects import common
from mavstack.pytest_plugin import flight_controller  # noqa: F401 (the fixture)
from mavstack.wire import encode
from tests.cli.conftest import flight, setup_signing
from tests.cli.watch.test_command import sender


def test_links_are_recorded_into_one_file(mav, tmp_path):
    path = tmp_path / "flight.tlog"
    other = encode(common.SystemTime(), system=2, component=1)
    with sender(flight(1)[0]) as first, sender(other) as second:
        result = mav("record", first, second, path, "--for", "0.4")
    assert result.code == 0
    log = open_log(path)
    assert sorted(log) == ["HEARTBEAT", "SYSTEM_TIME"]
    packets = sum(log.counts.values())
    assert result.err.splitlines()[-1] == f"mav record: recorded {packets} packets to {path}"
    assert result.out == ""


@pytest.mark.parametrize(("name", "words"), [("flight.pcap", ()), ("flight", ("--format", "pcap"))])
def test_a_capture_for_wireshark(mav, tmp_path, name, words):
    path = tmp_path / name
    with sender(b"".join(flight(1))) as url:
        assert mav("record", url, path, "--for", "0.4", *words).code == 0
    log = open_log(path)
    assert (log.format, log.skipped.total) == ("pcap", 0)
    assert sorted(log) == ["ATTITUDE", "HEARTBEAT"]


def test_a_flight_controller_that_speaks_msp_is_recorded(mav, tmp_path, flight_controller):  # noqa: F811
    path = tmp_path / "flight.tlog"
    result = mav("record", flight_controller.url, path, "--for", "1")
    assert result.code == 0, result.err
    log = open_log(path)
    assert {"HEARTBEAT", "ATTITUDE", "AUTOPILOT_VERSION"} <= set(log)


def test_only_selected_packets_are_recorded(mav, tmp_path):
    path = tmp_path / "flight.tlog"
    with sender(b"".join(flight(2))) as url:
        assert mav("record", url, path, "--for", "0.4", "--filter", "ATT*", "--system", "1").code == 0
    assert list(open_log(path)) == ["ATTITUDE"]


def test_a_key_is_never_recorded(mav, tmp_path):
    path = tmp_path / "flight.tlog"
    with sender(setup_signing() + flight(0)[0]) as url:
        result = mav("record", url, path, "--for", "0.4")
    assert "SETUP_SIGNING left out" in result.err
    assert list(open_log(path)) == ["HEARTBEAT"]


def test_files_have_a_limited_size(mav, tmp_path):
    with sender(b"".join(flight(20))) as url:
        limits = ("--max-size", "200", "--keep", "2")
        result = mav("record", url, tmp_path / "flight.tlog", "--for", "0.4", *limits)
    assert result.code == 0
    files = sorted(tmp_path.iterdir())
    assert len(files) == 2
    assert all(0 < file.stat().st_size <= 200 for file in files)
    assert f"files, the last one {files[-1]}" in result.err


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (["udpin://127.0.0.1:0", "{path}", "--keep", "2"], "--keep needs --max-size or --max-time"),
        (["{log}", "{path}"], "is a file; mav record records links"),
        (["udpin://127.0.0.1:0", "-", "--max-size", "5M"], "standard output is one file"),
    ],
)
def test_wrong_usage_is_reported(mav, tmp_path, words, problem):
    log = tmp_path / "old.tlog"
    log.write_bytes(b"")
    path = tmp_path / "new.tlog"
    result = mav("record", *(word.format(log=log, path=path) for word in words))
    assert result.code in (1, 2)
    assert problem in result.err
    assert not path.exists()


def test_an_existing_file_is_kept(mav, tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(b"precious")
    assert mav("record", "udpin://127.0.0.1:0", path, "--for", "1").code == 1
    assert path.read_bytes() == b"precious"


def test_a_link_without_packets_is_a_failure(mav, tmp_path):
    result = mav("record", "udpin://127.0.0.1:0", tmp_path / "flight.tlog", "--for", "0.2")
    assert result.code == 1
    assert "no data received" in result.err


def test_examples_of_the_help_parse():
    for line in EXAMPLES.splitlines():
        if line.startswith("  mav record"):
            words = shlex.split(line.partition(" | ")[0], comments=True)[2:]
            assert command_parser("record").parse_args(words).record == words[-1] or "--" in line


def wait_for_packets(path):
    """Wait until the file has packets; the time limit of the test ends a wait without result."""
    while not path.exists() or not path.stat().st_size:
        time.sleep(0.01)


@pytest.mark.flight
@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_a_recorder_that_is_ended_leaves_complete_records(tmp_path, number):
    path = tmp_path / "flight.tlog"
    with sender(b"".join(flight(20))) as url:
        words = [sys.executable, "-m", "mavstack", "record", url, str(path)]
        recorder = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
        wait_for_packets(path)
        os.kill(recorder.pid, number)
        _, errors = recorder.communicate()
    assert recorder.returncode == (-number if number == signal.SIGKILL else 128 + number)
    assert "Traceback" not in errors
    log = open_log(path)
    assert log.statistics.bad_bytes == 0
    if number == signal.SIGINT:
        assert f"mav record: recorded {log.statistics.packets} packets to {path}" in errors


@pytest.mark.nightly
@pytest.mark.timeout(900)
@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")
def test_a_hundred_kills_at_random_moments_lose_less_than_a_second(tmp_path):
    random = Random(13)
    for number in range(100):
        path = tmp_path / f"{number}.tlog"
        with sender(b"".join(flight(20))) as url:
            words = [sys.executable, "-m", "mavstack", "record", url, str(path)]
            recorder = subprocess.Popen(words, stderr=subprocess.DEVNULL)
            wait_for_packets(path)
            time.sleep(random.uniform(0, 0.5))
            killed = time.time()
            recorder.kill()
            recorder.wait()
        log = open_log(path)
        assert log.statistics.bad_bytes == 0
        assert killed - float(log["ATTITUDE"]["_time"][-1].astype("i8")) / 1e6 < 1
