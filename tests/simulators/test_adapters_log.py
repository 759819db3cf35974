"""Recorded flights as sensors."""

from __future__ import annotations

import pytest

from mavstack.dialects import Dialect, common
from mavstack.errors import InvalidArgumentError
from mavstack.sim import Simulation
from mavstack.sim.scenarios import take_off
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.physics import load_physics
from mavstack.simulators.px4 import Px4Interface
from mavstack.wire import Parser

DIALECT = Dialect.load("common")


@pytest.fixture(params=["px4", "ardupilot"])
def flight(request, tmp_path):
    """Return the path of a log of a simulated flight."""
    simulation = Simulation(storage=tmp_path)
    vehicle = simulation.add("copter", request.param)
    take_off(simulation, vehicle)
    simulation.advance(simulation.now + 10.0)
    simulation.close()
    kinds = {".ulg", ".BIN"}
    logs = [path for path in tmp_path.rglob("*") if path.suffix in kinds and path.stat().st_size > 1000]
    return max(logs, key=lambda path: path.stat().st_size)


def test_recorded_sensors_reach_px4(flight):
    physics, _ = load_physics(f"log:{flight}")
    state = physics.reset(DEFAULT_HOME, 0.0)
    interface = Px4Interface(DIALECT, physics.sensors(DEFAULT_HOME))
    interface.connected()
    found, heights = [], []
    for _ in range(2500):
        found += [packet.message for packet in Parser(DIALECT).feed(interface.step(state))]
        state = physics.step((), 0.004).checked()
        heights.append(-state.position[2])
    sensors = [each for each in found if isinstance(each, common.HilSensor)]
    fixes = [each for each in found if isinstance(each, common.HilGps)]
    assert len(sensors) == 2500
    assert sensors[-1].zacc == pytest.approx(-9.8, abs=3.0)
    if flight.suffix == ".BIN":  # simulated PX4 logs no magnetometer
        assert any(int(each.fields_updated) & 0x1C0 for each in sensors)
    assert any(int(each.fields_updated) & 0x1A00 for each in sensors)
    assert len(fixes) > 5
    assert fixes[-1].lat == pytest.approx(DEFAULT_HOME.latitude * 1e7, abs=5000)
    assert max(heights) > 3.0


def test_a_lost_gps_hides_the_recorded_position(flight):
    physics, _ = load_physics(f"log:{flight}")
    sensors = physics.sensors(DEFAULT_HOME)
    sensors.faults.inject("gps-lost")
    state = physics.reset(DEFAULT_HOME, 0.0)
    fixes = [reading.fix for step in range(1500) if (reading := sensors.sample(state, step * 0.004)).fix]
    assert fixes
    assert not any(fix.is_valid for fix in fixes)


def test_wrong_files_are_reported(tmp_path):
    with pytest.raises(InvalidArgumentError, match="there is no such file"):
        load_physics("log:/no/such.ulg")
    (tmp_path / "x.ulg").write_bytes(b"ULog\x01\x12\x35\x01" + b"\0" * 8)
    with pytest.raises(InvalidArgumentError, match="cannot be made: "):
        load_physics(f"log:{tmp_path / 'x.ulg'}")
