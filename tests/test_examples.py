"""The programs and commands in README, and the examples, run unchanged."""

from __future__ import annotations

import os
import re
import runpy
import shlex
import shutil
import socket
import subprocess
import sys
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from mavstack.sim.background import BackgroundSimulator

ROOT = Path(__file__).parents[1]
PROGRAMS = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text("utf-8"), re.DOTALL)
COMMANDS = re.findall(r"^(mav [^#\n]+)", (ROOT / "README.md").read_text("utf-8"), re.MULTILINE)


def run(*command: str, url: str = "") -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "MAVSTACK_URL": url}
    return subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, timeout=120, check=False, input="", env=environment
    )


@contextmanager
def vehicle_for(program):
    """Run a simulated vehicle for the port on which the program listens, if it listens on one."""
    port = re.search(r"udpin://0.0.0.0:(\d+)", program)
    if port is None:
        yield
        return
    with simulated(f"udpout://127.0.0.1:{port[1]}"):
        yield


@contextmanager
def simulated(url):
    command = [sys.executable, "-m", "mavstack", "sim", "--speed", "5", "--out", url]
    null = subprocess.DEVNULL
    with subprocess.Popen(command, cwd=ROOT, stdin=null, stdout=null) as vehicle:
        try:
            yield
        finally:
            vehicle.terminate()


@pytest.mark.xdist_group("programs of the README, on their ports")
@pytest.mark.parametrize("number", range(len(PROGRAMS)))
def test_the_programs_of_the_readme_run(number):
    with vehicle_for(PROGRAMS[number]):
        done = run(sys.executable, "-W", "error", "-c", PROGRAMS[number])
    assert done.returncode == 0, done.stderr
    assert done.stdout


def test_the_readme_has_programs_and_commands():
    assert len(PROGRAMS) >= 3
    assert len(COMMANDS) >= 6


@pytest.fixture(scope="module")
def vehicle_url():
    """Run one vehicle for all commands, which connect one after the other."""
    with BackgroundSimulator("copter", speed=5.0, link="udpin://127.0.0.1:0?idle=600") as vehicle:
        yield f"udpout://127.0.0.1:{vehicle.port}"


@pytest.mark.flight
@pytest.mark.xdist_group("commands of the README, in their order")
@pytest.mark.parametrize("command", COMMANDS, ids=str.strip)
def test_the_commands_of_the_readme_run(command, vehicle_url, tmp_path):
    words = shlex.split(command)
    if words[1] == "watch" and words[2] != "flight.tlog":
        pytest.skip("needs a vehicle; tests/links covers the links")
    if words[1] == "web" and "--help" not in words:
        pytest.skip("runs until Ctrl-C; tests/cli/web runs it")
    # Some commands write files beside the log.
    log = shutil.copy(ROOT / "tests" / "recordings" / "flight.tlog", tmp_path)
    words = [str(log) if word == "flight.tlog" else word for word in words]
    if words[1] == "sim":
        words += ["--for", "1", "--speed", "max"]
    done = run(sys.executable, "-m", "mavstack", *words[1:], url=vehicle_url)
    assert done.returncode == 0, done.stderr
    assert done.stdout or words[1] in ("shell", "vehicle")


@pytest.mark.flight
@pytest.mark.parametrize("example", sorted((ROOT / "examples").glob("*.py")), ids=lambda path: path.stem)
def test_examples_run(example):
    done = run(sys.executable, "-W", "error", str(example))
    assert done.returncode == 0, done.stderr
    assert done.stdout


@pytest.mark.parametrize(("name", "port"), [("csv_sender", 5781), ("zermatt", 5760)])
def test_a_sender_whose_port_is_in_use_ends_with_one_line(name, port):
    with socket.socket() as sock:
        with suppress(OSError):  # another program has it: as good
            sock.bind(("127.0.0.1", port))
            sock.listen()
        done = run(sys.executable, str(ROOT / "examples" / "dashboards" / f"{name}.py"))
    assert done.returncode == 1
    assert re.fullmatch(rf"cannot [^\n]*{port}[^\n]* in use[^\n]*\n", done.stderr), done.stderr


def test_the_drones_of_the_dashboard_circle():
    example = runpy.run_path(str(ROOT / "examples" / "dashboards" / "zermatt.py"))
    simulation = example["simulate"]()
    headings = []
    for _ in range(2):
        headings.append([drone.body.truth.yaw for drone in simulation.vehicles])
        for _ in range(round(10 / simulation.step_length)):
            simulation.step()
    for before, after, drone in zip(*headings, simulation.vehicles, strict=True):
        assert drone.autopilot.altitude > 40
        assert abs(after - before) > 0.2
    simulation.close()
