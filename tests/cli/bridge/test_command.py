"""`mav bridge`: its examples, wrong usage, and a bridge as a process."""

from __future__ import annotations

import shlex
import signal
import subprocess
import sys

import pytest

from mavstack.bridges.core.registry import BRIDGES
from mavstack.cli.main import main
from mavstack.cli.registry import command_parser
from mavstack.sim.background import BackgroundSimulator
from tests.bridges.ros2.running import free_port, zenoh_router

EXAMPLES = [line.partition("   ")[0] for _, entry in BRIDGES.items() for line in entry.examples]


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_have_the_options_that_there_are(example: str) -> None:
    words = shlex.split(example)
    assert command_parser("bridge").parse_args(words[2:]).bridge == words[2]


@pytest.mark.parametrize(
    ("words", "code", "problem"),
    [
        (["--domain", "500"], 2, "argument --domain: must be from 0 to 232, got 500"),
        (["--namespace", "1x"], 2, "a namespace must have letters, digits and _"),
        (["--name", "alpha"], 2, "argument --name: must be ID=NAME such as 1=alpha"),
        (["--connect", f"tcp/127.0.0.1:{free_port()}"], 1, "connecting to the Zenoh router"),
        (["--via", "pigeon"], 2, "invalid choice"),
    ],
)
def test_wrong_usage(words: list[str], code: int, problem: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bridge", "ros2", "udpin://127.0.0.1:0", *words]) == code
    assert problem in capsys.readouterr().err


@pytest.mark.interop
def test_a_bridge_reports_that_it_is_ready_and_ends_by_sigterm() -> None:
    pytest.importorskip("zenoh")
    with BackgroundSimulator() as simulator, zenoh_router() as port:
        words = ["bridge", "ros2", simulator.url, "--connect", f"tcp/127.0.0.1:{port}"]
        command = [sys.executable, "-m", "mavstack", *words]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            line = process.stdout.readline()
            assert line == f"ROS 2 domain 0 over Zenoh by tcp/127.0.0.1:{port}; read only; Ctrl-C to end\n"
            process.send_signal(signal.SIGTERM)
            assert process.wait(20) == 128 + signal.SIGTERM


@pytest.mark.parametrize(
    ("words", "code", "problem"),
    [
        (["--prefix", "a//b"], 2, "a prefix of keys must have letters"),
        (["--name", "1=a/b"], 2, "the name of a vehicle must have letters"),
        (["--gateway", "@x"], 2, "the name of a gateway must have letters"),
        (["--state-rate", "0"], 2, "must be above 0, at most 100, got 0"),
        (["--batch-time", "-1"], 2, "must be from 0 to 1000, got -1"),
        (["--tls-cert", "a.pem"], 1, "--tls-cert and --tls-key need each other"),
        (["--connect", f"tcp/127.0.0.1:{free_port()}"], 1, "connecting to the Zenoh router"),
    ],
)
def test_wrong_usage_of_a_gateway(
    words: list[str], code: int, problem: str, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("zenoh")
    assert main(["bridge", "zenoh", "udpin://127.0.0.1:0", *words]) == code
    assert problem in capsys.readouterr().err


@pytest.mark.interop
def test_a_gateway_as_a_process() -> None:
    pytest.importorskip("zenoh")
    with BackgroundSimulator() as simulator, zenoh_router() as port:
        words = ["bridge", "zenoh", simulator.url, "--connect", f"tcp/127.0.0.1:{port}", "--mavlink-server"]
        command = [sys.executable, "-m", "mavstack", *words]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            line = process.stdout.readline()
            assert line == f"fleet mavstack on Zenoh by tcp/127.0.0.1:{port}; read only; Ctrl-C to end\n"
            process.send_signal(signal.SIGTERM)
            assert process.wait(20) == 128 + signal.SIGTERM
