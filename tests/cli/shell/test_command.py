"""`mav shell` as a command: scripts, lines, pipes, outputs, exit codes; and all that its help shows."""

from __future__ import annotations

import io
import shlex

import pytest

from mavstack.cli.shell import command as shell
from mavstack.cli.shell.command import EXAMPLES
from mavstack.cli.shell.registry import COMMANDS
from mavstack.cli.shell.session import Command
from mavstack.links import MemoryNetwork
from mavstack.node import forwarding
from mavstack.sim import Firmware, VehicleType
from tests.cli.harness import COPTER, PX4_COPTER, CliHarness
from tests.vehicle.world import kind_name


@pytest.fixture
def pipe(monkeypatch):
    """Give the shell lines by a pipe."""

    def fill(text):
        async def lines():
            for line in text.splitlines():
                yield line

        monkeypatch.setattr(shell, "stdin_lines", lines)
        monkeypatch.setattr("sys.stdin", io.StringIO(text))

    return fill


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", [COPTER, PX4_COPTER], ids=kind_name)
def test_command_option(simulate, mav, kind):
    harness = simulate(kind)
    result = mav("shell", "--command", "arm throttle; takeoff 10")
    assert result.code == 0
    assert result.out == "armed\n"
    assert "found: quadrotor" in result.err
    assert -harness.vehicle.body.truth.down == pytest.approx(10, abs=1.5)


@pytest.mark.flight
def test_script_option(simulate, mav, tmp_path):
    simulate()
    (script := tmp_path / "flight.txt").write_text("mode guided\narm throttle # up\n\nbad\ndisarm\n")
    result = mav("shell", "--script", script)
    assert result.code == 1
    assert result.out == "mode GUIDED\narmed\n"
    assert f"{script}:4: there is no command 'bad'" in result.err
    result = mav("shell", "--script", script, "--keep-going")
    assert result.code == 1
    assert result.out == "mode GUIDED\narmed\ndisarmed\n"


@pytest.mark.flight
def test_lines_from_a_pipe(simulate, mav, pipe):
    simulate()
    pipe("arm throttle\ndisarm\n")
    result = mav("shell")
    assert (result.code, result.out) == (0, "armed\ndisarmed\n")


@pytest.mark.flight
def test_no_vehicle_is_a_failure(simulate, mav):
    simulate()
    result = mav("shell", "--system", 9, "--timeout", 2, "--command", "info")
    assert result.code == 1
    assert result.err.splitlines()[-1].startswith("waiting for vehicle 9")


@pytest.mark.flight
def test_selected_vehicle(simulate, mav):
    harness = simulate(COPTER, PX4_COPTER)
    assert mav("shell", "--system", 2, "--command", "arm").code == 0
    assert [vehicle.autopilot.armed for vehicle in harness.simulation.vehicles] == [False, True]


@pytest.mark.flight
def test_missing_script(simulate, mav, tmp_path):
    simulate()
    result = mav("shell", "--script", tmp_path / "none.txt")
    assert result.code == 1
    assert "No such file or directory" in result.err


@pytest.mark.flight
def test_output_option(simulate, mav, monkeypatch):
    simulate()
    behind = MemoryNetwork()
    monkeypatch.setattr(forwarding, "open_link", lambda url: behind.link())
    station = behind.link()

    async def open_station(session, words):
        await station.open()

    command = Command("station", "", "open the ground station", open_station, needs_vehicle=False)
    monkeypatch.setattr(shell, "COMMANDS", {**COMMANDS, "station": command})
    result = mav("shell", "--out", "udpout://127.0.0.1:9", "--command", "station; sleep 2; output list")
    assert result.code == 0
    assert result.out.split()[:3] == ["0", "memory://pair", "1"]
    assert int(result.out.split()[4]) > 5


@pytest.mark.parametrize(
    "words", [["--script", "a", "--command", "b"], ["--timeout", "never"], ["--nonsense"]]
)
def test_wrong_usage(mav, words):
    assert mav("shell", *words).code == 2


@pytest.mark.nightly
def test_examples_of_the_help_run(simulate, mav, pipe, tmp_path, monkeypatch):
    """Return the example lines except those of an interactive shell."""
    (tmp_path / "flight.txt").write_text("info\n")
    monkeypatch.chdir(tmp_path)
    for line in EXAMPLES.splitlines()[1:7]:
        simulate()
        before, bar, after = line.rpartition("|")
        if bar:
            pipe(shlex.split(before)[1] + "\n")
        elif "--" not in line or "--out" in line or "/dev/" in line:
            continue
        words = shlex.split(after, comments=True)[1:]
        assert mav(*words).code == 0, line


#: Examples that need a file, an output or another firmware have tests of their own.
ELSEWHERE = {"wp set 2", "nsh ver all", "script"}
#: Vehicles of the examples that a copter with ArduPilot does not run.
VEHICLES = {"actuator": PX4_COPTER, "transition": (VehicleType.VTOL, Firmware.ARDUPILOT)}


@pytest.mark.flight_cases(12)
@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("command", list(dict.fromkeys(COMMANDS.values())), ids=lambda command: command.name)
def test_examples_of_each_shell_command_run(simulate, mav, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    before = {
        "guided": "mode guided; arm throttle; takeoff 10; ",
        "orbit": "mode guided; arm throttle; takeoff 10; rc 3 1500; ",
        "setyaw": "mode guided; arm throttle; takeoff 10; ",
        "setspeed": "mode guided; arm throttle; takeoff 10; ",
        "land": "mode guided; arm throttle; takeoff 10; ",
        "rtl": "mode guided; arm throttle; takeoff 10; ",
        "hold": "mode guided; arm throttle; takeoff 10; ",
        "takeoff": "mode guided; arm throttle; ",
        "transition": "arm throttle; takeoff 30; ",
    }.get(command.name, "")
    confirmation = " --yes" if command.name == "motortest" else ""  # asked for, unless a script gives it
    lines = [example + confirmation for example in command.examples if example not in ELSEWHERE]
    if not lines:
        pytest.skip("tried elsewhere")
    payloads = command.name in ("camera", "gimbal")
    harness = simulate(VEHICLES.get(command.name, COPTER), payloads=payloads)
    for name in ("GRIP_ENABLE", "WINCH_TYPE"):
        if name in harness.vehicle.parameters:
            harness.vehicle.parameters.set(name, 1)
    result = mav(
        "shell",
        "--command",
        before + "; ".join(line.replace(";", r"\;") if '"' not in line else line for line in lines),
    )
    assert result.code == 0, result.err


def test_help_needs_no_vehicle(mav, monkeypatch):
    harness = CliHarness(monkeypatch)
    harness.simulation.vehicles[0].cut(True)
    result = mav("shell", "--command", "help", "--timeout", 1)
    assert (result.code, result.err) == (0, "")
    assert "takeoff" in result.out
