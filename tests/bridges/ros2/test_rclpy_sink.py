"""ROS 2 by real rclpy on Fast DDS: every row, and flights of a script as written for MAVROS.

The installation is that of `python -m tools.ros_installation`; without it the tests skip.
"""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

from mavstack.sim.background import BackgroundSimulator
from tests.bridges.ros2.running import free_port
from tools import ros_installation

PROGRAMS = Path(__file__).with_name("programs")
pytestmark = [
    pytest.mark.interop,
    pytest.mark.skipif(not ros_installation.is_complete(), reason="run python -m tools.ros_installation"),
]
BRIDGE = "import sys; from mavstack.cli.main import main; sys.exit(main())"


def python(*words: str, domain: int, timeout: float = 90.0) -> str:
    """Run a program in the ROS installation and return what it prints."""
    environment = {**ros_installation.environment(), "ROS_DOMAIN_ID": str(domain)}
    command = [str(ros_installation.FOLDER / "bin" / "python"), *words]
    done = subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=timeout, check=False
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-4000:]
    return done.stdout


def domain_id() -> int:
    """Return a domain that other tests at the same time do not use."""
    return free_port() % 200 + 10


@pytest.mark.smoke
def test_rclpy_reads_the_bytes_of_every_row_and_knows_every_hash() -> None:
    report = json.loads(python(str(PROGRAMS / "rows.py"), domain=domain_id()).splitlines()[-1])
    assert report["problems"] == []
    assert report["types"] > 150
    assert report["hashes"] > 250


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_a_script_for_mavros_flies(firmware: str) -> None:
    domain = domain_id()
    with BackgroundSimulator("copter", firmware, speed=2.0) as simulator:
        words = [
            "bridge",
            "ros2",
            simulator.url,
            "--via",
            "rclpy",
            "--domain",
            str(domain),
            "--allow-control",
        ]
        command = [str(ros_installation.FOLDER / "bin" / "python"), "-c", BRIDGE, *words]
        with subprocess.Popen(
            command, env=ros_installation.environment(), stdout=subprocess.PIPE, text=True
        ) as bridge:
            try:
                assert bridge.stdout is not None
                assert "ROS 2 domain" in bridge.stdout.readline()
                output = python(str(PROGRAMS / "offboard.py"), firmware, domain=domain)
            finally:
                bridge.terminate()
    result: dict[str, Any] = json.loads(output.splitlines()[-1])
    assert result["armed"], result
    assert result["height"] > 4.0, result
    assert result["moved"] > 3.0, result
    assert result["mission"] == 3, result
    assert result["landed"], result
