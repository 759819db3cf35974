"""Sensors."""

from __future__ import annotations

from statistics import fmean, stdev

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.sensors import FAULTS, SensorNoise, Sensors, pressure_at, temperature_at
from mavstack.simulators.state import State


def test_the_same_seed_gives_the_same_values():
    def values(seed):
        sensors = Sensors(DEFAULT_HOME, seed)
        return [
            (sensors.inertial(State()), sensors.magnetic(State()), sensors.fix(State())) for _ in range(5)
        ]

    assert values(1) == values(1) != values(2)


def test_noise_has_its_deviation_and_no_mean():
    sensors = Sensors(DEFAULT_HOME, noise=SensorNoise(accelerometer=0.1))
    values = [sensors.inertial(State()).acceleration[0] for _ in range(4000)]
    assert fmean(values) == pytest.approx(0.0, abs=0.01)
    assert stdev(values) == pytest.approx(0.1, rel=0.1)


def test_the_standard_atmosphere():
    assert pressure_at(0.0) == pytest.approx(1013.25)
    assert pressure_at(1000.0) == pytest.approx(898.7, abs=0.3)
    assert temperature_at(1000.0) == pytest.approx(8.5)


def test_positions_walk_within_metres():
    sensors = Sensors(DEFAULT_HOME)
    altitudes = [sensors.fix(State()).altitude for _ in range(2000)]
    assert max(abs(altitude - DEFAULT_HOME.altitude) for altitude in altitudes) < 3.0
    assert len(set(altitudes)) == 2000


def changed_by(fault):
    """Return what a fault changes for a body that moves."""
    state = State(velocity=(20.0, 0.0, 0.0), rates=(0.1, 0.2, 0.3), specific_force=(1.0, 0.0, -9.0))
    moved = State((0.0, 0.0, -100.0), state.velocity, state.attitude, (0.5, 0.5, 0.5), (3.0, 0.0, -8.0))
    quiet = Sensors(DEFAULT_HOME, noise=SensorNoise(*[0.0] * 7))
    broken = Sensors(DEFAULT_HOME, noise=SensorNoise(*[0.0] * 7))
    for sensors in (quiet, broken):
        sensors.inertial(state)
        sensors.altitude(state)
    broken.set_fault(fault)
    reads = {
        "inertial": lambda sensors: sensors.inertial(moved),
        "magnetic": lambda sensors: sensors.magnetic(moved),
        "altitude": lambda sensors: sensors.altitude(moved),
        "airspeed": lambda sensors: sensors.airspeed(moved),
        "fix": lambda sensors: sensors.fix(moved),
    }
    return {name for name, read in reads.items() if read(quiet) != read(broken)}


@pytest.mark.parametrize(
    ("fault", "sensor"),
    [
        ("gps-lost", "fix"),
        ("imu-frozen", "inertial"),
        ("imu-biased", "inertial"),
        ("magnetometer-disturbed", "magnetic"),
        ("barometer-blocked", "altitude"),
        ("airspeed-blocked", "airspeed"),
    ],
)
def test_a_fault_changes_its_sensor_alone(fault, sensor):
    assert changed_by(fault) == {sensor}


def test_all_faults_are_tested_and_end():
    sensors = Sensors(DEFAULT_HOME)
    for name in FAULTS:
        sensors.set_fault(name)
        sensors.set_fault(name, is_present=False)
    assert not sensors.faults
    with pytest.raises(InvalidArgumentError, match="there is no fault 'gps'"):
        sensors.set_fault("gps")
