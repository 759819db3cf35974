"""The fixtures of the pytest plugin, used by tests in a separate run of pytest."""

from __future__ import annotations

import sys
from subprocess import run

TESTS = """
import pytest
from mavstack.dialects import common
from mavstack.sync import Node

def test_a_vehicle_on_the_ground(vehicle):
    with Node(vehicle.url.replace(":", "://", 1)) as ground:
        remote = ground.wait_for_autopilot()
        assert not remote.info.armed

@pytest.mark.vehicle(vehicle_type="plane", firmware="px4", seed=4)
def test_a_vehicle_in_the_air(flying_vehicle):
    assert flying_vehicle.vehicle.vehicle_type == "plane"
    assert flying_vehicle.vehicle.autopilot.altitude > 30

def test_a_vehicle_in_virtual_time(virtual_vehicle):
    async def flight(remote):
        import asyncio
        await asyncio.sleep(3)
        await remote.command(common.MavCmd.COMPONENT_ARM_DISARM, 1)
        await asyncio.sleep(600)
        return remote.info.armed

    assert virtual_vehicle.run(flight) is False     # it disarms automatically
"""


def test_the_fixtures_need_no_setup(tmp_path):
    (tmp_path / "test_fixtures.py").write_text(TESTS)
    plugin = ["-p", "mavstack.pytest_plugin"] if not _is_installed() else []
    command = [sys.executable, "-m", "pytest", "-q", "--strict-markers", "-p", "no:cacheprovider", *plugin]
    result = run([*command, str(tmp_path)], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert "3 passed" in result.stdout, result.stdout + result.stderr


def _is_installed() -> bool:
    from importlib.metadata import entry_points

    return any(entry.value == "mavstack.pytest_plugin" for entry in entry_points(group="pytest11"))
