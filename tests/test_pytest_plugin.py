"""The fixtures of the pytest plugin, used by tests in a separate run of pytest."""

from __future__ import annotations

import sys
from subprocess import run

import pytest

TESTS = """
import pytest
from mavstack.errors import CommandDenied
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
    async def flight(vehicle):
        await vehicle.wait_until_ready()
        await vehicle.arm()
        await vehicle.takeoff(10)
        assert 9 < vehicle.position.relative_altitude < 11
        await vehicle.land()
        return vehicle.armed

    assert virtual_vehicle.run(flight) is False
    assert virtual_vehicle.vehicle.autopilot.landed

def test_a_refusal_has_its_reason(virtual_vehicle):
    async def flight(vehicle):
        with pytest.raises(CommandDenied, match="System not initialised"):
            await vehicle.arm()

    virtual_vehicle.run(flight)

@pytest.mark.vehicle(loss=0.1, latency=0.4, bandwidth=20_000)
def test_a_slow_link_in_virtual_time(virtual_vehicle):
    async def flight(vehicle):
        return (await vehicle.component.ping()).minimum

    assert virtual_vehicle.run(flight) >= 0.8

@pytest.mark.vehicle(vehicle_type="rover", latency=0.2)
def test_a_slow_link(vehicle):
    with Node(vehicle.url) as ground:
        assert ground.wait_for_autopilot().ping(1).minimum >= 0.4
"""


@pytest.mark.flight
def test_the_fixtures_need_no_setup(tmp_path):
    (tmp_path / "test_fixtures.py").write_text(TESTS)
    plugin = ["-p", "mavstack.pytest_plugin"] if not _is_installed() else []
    command = [sys.executable, "-m", "pytest", "-q", "--strict-markers", "-p", "no:cacheprovider", *plugin]
    result = run([*command, str(tmp_path)], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert "6 passed" in result.stdout, result.stdout + result.stderr


def _is_installed() -> bool:
    from importlib.metadata import entry_points

    return any(entry.value == "mavstack.pytest_plugin" for entry in entry_points(group="pytest11"))
