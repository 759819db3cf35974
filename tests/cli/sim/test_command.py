from __future__ import annotations

import json
import signal
import subprocess
import sys

import pytest

from mavstack.cli.sim.command import _impaired
from mavstack.links import open_link, parse_url
from mavstack.sim.simulation import Simulation

NOWHERE = "udpout://127.0.0.1:9"


def events(out: str) -> list[dict]:
    return [json.loads(line) for line in out.splitlines()]


def test_events_as_json(mav):
    result = mav("sim", "--out", NOWHERE, "--for", "4", "--speed", "max", "--json")
    assert (result.code, result.err) == (0, "")
    ready, *others = events(result.out)
    assert ready["event"] == "ready"
    assert ready["vehicles"] == [{"system": 1, "type": "copter", "firmware": "ardupilot"}]
    assert ready["links"] == [NOWHERE]
    assert any(event["event"] == "text" and event["system"] == 1 for event in others)


def test_a_mixed_fleet(mav):
    words = ["--type", "copter,rover", "--firmware", "px4", "--count", "3", "--system", "20"]
    result = mav("sim", *words, "--out", NOWHERE, "--for", "1", "--speed", "max")
    assert result.code == 0
    shown = result.out.splitlines()
    assert shown[:3] == ["system 20: px4 copter", "system 21: px4 rover", "system 22: px4 copter"]
    assert shown[3] == f"on {NOWHERE}"


def test_rangefinders_and_obstacles(mav):
    words = ["--rangefinder", "downward:sonar", "--rangefinder", "forward", "--obstacle", "30,0,2,15"]
    result = mav("sim", *words, "--out", NOWHERE, "--for", "1", "--speed", "max")
    assert (result.code, result.err) == (0, "")
    equipment = "rangefinder downward sonar, rangefinder forward laser, proximity sensor"
    assert result.out.splitlines()[0] == f"system 1: ardupilot copter with {equipment}"


def test_an_older_version(mav, monkeypatch):
    monkeypatch.setattr("mavstack.sim.simulation.Simulation.add", spied := Spy(Simulation.add))
    words = ["--type", "rover", "--firmware", "ardupilot,px4", "--count", "2", "--ardupilot-version", "4.1"]
    assert mav("sim", *words, "--out", NOWHERE, "--for", "1", "--speed", "max").code == 0
    assert [vehicle.profile.version[:2] for vehicle in spied.added] == [(4, 1), (1, 16)]
    refused = mav("sim", "--firmware", "px4", "--ardupilot-version", "4.1", "--out", NOWHERE)
    assert (refused.code, "--ardupilot-version needs --firmware ardupilot" in refused.err) == (2, True)
    for text in ("4", "4.x", "4.1.2.3", "4.999"):
        assert mav("sim", "--ardupilot-version", text).code == 2


class Spy:
    """A method that keeps the vehicles that it returned."""

    def __init__(self, method):
        self.method, self.added = method, []

    def __get__(self, simulation, kind):
        def add(*args, **options):
            self.added.append(self.method(simulation, *args, **options))
            return self.added[-1]

        return add


def test_one_port_per_vehicle(mav):
    words = ["--count", "3", "--each", "--out", "udpout://127.0.0.1:9001"]
    result = mav("sim", *words, "--for", "0.5", "--speed", "max", "--json")
    links = events(result.out)[0]["links"]
    assert links == [f"udpout://127.0.0.1:{port}" for port in (9001, 9002, 9003)]


@pytest.mark.flight
def test_faults_from_the_command_line_and_from_a_file(mav, tmp_path):
    script = tmp_path / "faults.txt"
    script.write_text("# a bad day\n1 gps off\n2.5 1: battery 15   # nearly empty\n")
    words = ["--script", str(script), "--fault", "2 compass 90"]
    result = mav("sim", *words, "--out", NOWHERE, "--for", "4", "--speed", "max", "--json")
    faults = [
        (round(event["time"], 1), event["text"]) for event in events(result.out) if event["event"] == "fault"
    ]
    assert faults == [(1.0, "gps off"), (2.0, "compass 90"), (2.5, "battery 15")]


@pytest.mark.parametrize(
    "words",
    [
        ["--type", "spaceship"],
        ["--firmware", "cleanflight"],
        ["--count", "0"],
        ["--count", "256"],
        ["--home", "91,0"],
        ["--loss", "2"],
        ["--latency", "-1"],
        ["--speed", "0"],
        ["--wind", "5"],
        ["--wind", "5,270,0.1,9"],
        ["--system", "300"],
        ["--out", "nonsense://1"],
        ["--bandwidth", "many"],
        ["--rangefinder", "sideways"],
        ["--obstacle", "30,0"],
    ],
)
def test_wrong_usage(mav, words):
    result = mav("sim", *words, "--for", "0.1")
    assert result.code == 2, result
    assert result.err


@pytest.mark.parametrize(
    "words",
    [
        ["--fault", "soon gps off"],
        ["--fault", "1 pigs fly"],
        ["--script", "missing.txt"],
        ["--count", "20", "--system", "250"],
        ["--each", "--count", "2", "--out", "serial:///dev/ttyACM0"],
        ["--out", "tcpout://127.0.0.1:1"],
    ],
)
def test_errors_are_one_line(mav, words):
    result = mav("sim", *words, "--for", "0.1")
    assert result.code in (1, 2)
    assert result.err.count("\n") == 1
    assert result.err.startswith("mav sim: ")


def test_impairments_become_url_options(mav, capsys):
    class Arguments:
        loss, latency, bandwidth, seed, radio = 0.1, 200.0, "5760", 4, None

    impaired = parse_url(_impaired("udpout://127.0.0.1:9", Arguments))
    assert dict(impaired.options) == {"loss": "0.1", "latency": "200ms", "bandwidth": "5760", "seed": "4"}
    own = parse_url(_impaired("udpout://127.0.0.1:9?loss=0.5", Arguments))
    assert own.options["loss"] == "0.5"
    assert open_link(str(impaired))
    Arguments.loss = Arguments.latency = Arguments.bandwidth = None
    Arguments.radio = "sik"
    assert parse_url(_impaired("udpout://127.0.0.1:9", Arguments)).options["radio"] == "sik"
    Arguments.radio = None
    assert _impaired("udpout://127.0.0.1:9", Arguments) == "udpout://127.0.0.1:9"


@pytest.mark.flight
@pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")
def test_faults_from_stdin_and_ctrl_c():
    command = [sys.executable, "-m", "mavstack", "sim", "--out", NOWHERE, "--json"]
    process = subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert json.loads(process.stdout.readline())["event"] == "ready"
    process.stdin.write("gps off\npigs fly\n")
    process.stdin.flush()
    while (event := json.loads(process.stdout.readline()))["event"] != "fault":
        pass
    assert event["text"] == "gps off"
    assert "pigs fly" in process.stderr.readline()
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (130, "")


@pytest.mark.flight
def test_runs_without_stdin():
    command = [sys.executable, "-m", "mavstack", "sim", "--out", NOWHERE, "--for", "0.5"]
    result = subprocess.run(
        command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60, check=False
    )
    assert (result.returncode, result.stderr) == (0, "")


def test_value_that_begins_with_a_minus_sign(mav):
    words = ("--for", "1", "--speed", "max", "--out", "udpout://127.0.0.1:9")
    assert mav("sim", "--home", "-35.3,149.1,584,0", *words).code == 0
