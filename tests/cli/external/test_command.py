"""`mav external` with a simulated vehicle: lines of standard input and of datagrams, and the reasons."""

from __future__ import annotations

import json
import socket
import threading
import time

import pytest

from mavstack.cli.external import command
from mavstack.cli.main import main
from mavstack.sim import BackgroundSimulator

VISION = {"VISO_TYPE": 1, "EK3_SRC1_POSXY": 6, "EK3_SRC1_YAW": 6}


@pytest.fixture(scope="module")
def simulator():
    with BackgroundSimulator() as running:
        yield running


@pytest.fixture
def feed(capsys, monkeypatch, simulator):
    """Run the command with lines on standard input."""

    def run(kind, *lines, words=(), code=0):
        async def stdin():
            for line in lines:
                yield line

        monkeypatch.setattr(command, "stdin_lines", stdin)
        assert main(["external", kind, "--url", simulator.url, *words]) == code
        return capsys.readouterr()

    return run


def test_check_names_the_settings(feed):
    assert "VISO_TYPE is 0: set it to 1" in feed("check", code=1).out
    found = json.loads(feed("check", words=["--json"], code=1).out)
    assert found["used"] is False
    assert "nothing was sent" not in found["reasons"]


def test_csv_with_a_header_and_the_reasons(feed):
    done = feed("odometry", "x,y,z,qw,qx,qy,qz", *["0,0,1,1,0,0,0"] * 5)
    assert "the estimator does not use it: VISO_TYPE is 0" in done.out
    assert "5 records sent, 0 refused" in done.out


def test_json_lines_and_refused_ones(feed):
    lines = ['{"position": [1, 2, 3]}', '{"position": [1, 2]}', '{"record": "gps", "latitude": 47}', "1,x"]
    done = feed("vision", *lines, '{"record": "distance", "distance": 3}', words=["--json"])
    found = json.loads(done.out)
    assert (found["sent"], found["refused"], found["used"]) == (2, 2, False)
    assert "record 2: vision: position needs 3 finite numbers" in done.err
    assert "record 3: gps: longitude is missing" in done.err


def test_a_long_line_is_refused(feed):
    done = feed("distance", f'{{"distance": 3{" " * 16_384}}}', code=1)
    assert "record 1: the line is longer than 16384 characters" in done.err


def test_nothing_sent_is_a_failure(feed):
    assert "0 records sent, 1 refused" in feed("landing-target", "1,2", code=1).out


def test_datagrams_that_the_estimator_uses(capsys):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    ended = threading.Event()

    def send() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            while not ended.wait(0.03):
                sender.sendto(f"{time.time()},0,0,0,1,0,0,0\n".encode(), ("127.0.0.1", port))

    thread = threading.Thread(target=send)
    thread.start()
    try:
        with BackgroundSimulator() as simulator:
            for name, value in VISION.items():
                simulator.vehicle.parameters.set(name, value)
            simulator.vehicle.reboot()
            words = ["odometry", "--udp", f"127.0.0.1:{port}", "--for", "7", "--url", simulator.url]
            assert main(["external", *words]) == 0
    finally:
        ended.set()
        thread.join()
    assert "ms old: " in (text := capsys.readouterr().out)
    assert "VISO_TYPE" not in text
    assert " 0 refused" in text


def test_a_wind_is_sent_and_an_impossible_one_is_not(feed):
    assert "1 records sent, 0 refused" in feed("wind", "6.5,240,1,10").out
    done = feed("wind", "200,240", code=1)
    assert "a wind must be 0 to 100 m/s, got 200" in done.err
    assert "0 records sent, 1 refused" in done.out


def test_wrong_usage(feed):
    assert "odometre" in feed("odometre", code=2).err
    assert "frame" in feed("odometry", words=["--frame", "XYZ"], code=2).err
    assert "udp" in feed("odometry", words=["--udp", "no port"], code=2).err.lower()
