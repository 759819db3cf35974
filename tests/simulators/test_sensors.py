"""Sensors."""

from __future__ import annotations

import math
from statistics import fmean, stdev

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.rotation import from_euler
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.faults import FAULTS
from mavstack.simulators.sensor_model import SensorModel, SensorModels
from mavstack.simulators.sensors import EQUIPMENT, Sensors
from mavstack.simulators.state import State

DT = 0.004


def samples(sensors, count, state=None):
    return [sensors.sample(state or State(), index * DT) for index in range(count)]


def test_the_same_seed_gives_the_same_values_again_after_a_reset():
    sensors = Sensors(DEFAULT_HOME, 1)
    first = samples(sensors, 60)
    sensors.reset()
    assert samples(sensors, 60) == first == samples(Sensors(DEFAULT_HOME, 1), 60)
    assert samples(Sensors(DEFAULT_HOME, 2), 60) != first


def test_noise_has_its_deviation_and_no_mean():
    sensors = Sensors(DEFAULT_HOME, models=SensorModels(accelerometer=SensorModel(noise=0.1)))
    values = [each.acceleration[0] for each in samples(sensors, 4000)]
    assert fmean(values) == pytest.approx(0.0, abs=0.01)
    assert stdev(values) == pytest.approx(0.1, rel=0.1)


def test_each_sensor_has_its_rate():
    taken = samples(Sensors(DEFAULT_HOME, equipment=EQUIPMENT), 500)
    counts = {
        name: sum(getattr(each, name) is not None for each in taken)
        for name in ("magnetic", "altitude", "airspeed", "fix", "distance", "flow")
    }
    assert counts == {
        "magnetic": 100,
        "altitude": 100,
        "airspeed": 100,
        "fix": 20,
        "distance": 40,
        "flow": 40,
    }


def test_positions_walk_within_metres():
    altitudes = [each.fix.altitude for each in samples(Sensors(DEFAULT_HOME), 50_000) if each.fix]
    assert max(abs(altitude - DEFAULT_HOME.altitude) for altitude in altitudes) < 3.0
    assert len(set(altitudes)) == 2000


def test_a_rangefinder_looks_along_the_body():
    sensors = Sensors(DEFAULT_HOME, models=SensorModels.ideal(), equipment=["rangefinder"])
    leaning = State((0.0, 0.0, -10.0), attitude=from_euler(math.radians(60) * 0.99, 0.0, 0.0))
    assert sensors.sample(leaning, 0.0).distance == pytest.approx(19.66, abs=0.1)
    fallen = State((0.0, 0.0, -10.0), attitude=from_euler(1.5, 0.0, 0.0))
    assert sensors.sample(fallen, 0.05).distance == math.inf
    assert sensors.sample(State((0.0, 0.0, -100.0)), 0.1).distance == math.inf
    assert sensors.sample(State(range=3.0), 0.15).distance == 3.0
    assert Sensors(DEFAULT_HOME).sample(State(), 0.0).distance is None


def test_optical_flow_is_speed_by_height_and_turn():
    sensors = Sensors(DEFAULT_HOME, models=SensorModels.ideal(), equipment=["optical-flow"])
    flow = sensors.sample(State((0.0, 0.0, -5.0), (2.0, 1.0, 0.0), rates=(0.1, 0.2, 0.0)), 0.0).flow
    assert flow.rates == pytest.approx((0.1 - 1.0 / 5.0, 0.2 + 2.0 / 5.0))
    assert flow.quality == 255


def changed_by(fault):
    """Return the readings that a fault changes for a body that moves."""
    first = State((0.0, 0.0, -9.0), (20.0, 0.0, 0.0), rates=(0.1, 0.2, 0.3), battery=(16.0, 1.0))
    moved = State(
        (5.0, 0.0, -10.0),
        (20.0, 0.0, 0.0),
        from_euler(0.0, 0.0, 0.5),
        (0.5, 0.5, 0.5),
        (3.0, 0.0, -8.0),
        battery=(16.0, 1.0),
    )
    ideal = SensorModels.ideal()
    quiet, broken = (Sensors(DEFAULT_HOME, models=ideal, equipment=EQUIPMENT) for _ in range(2))
    if fault == "imu-shaken":
        quiet, broken = (Sensors(DEFAULT_HOME, equipment=EQUIPMENT) for _ in range(2))
    for sensors in (quiet, broken):
        sensors.sample(first, 0.0)
    broken.faults.inject(fault)
    good, bad = quiet.sample(moved, 1.0), broken.sample(moved, 1.0)
    names = (
        "acceleration",
        "rates",
        "magnetic",
        "altitude",
        "airspeed",
        "fix",
        "distance",
        "flow",
        "battery",
    )
    return {name for name in names if getattr(good, name) != getattr(bad, name)}


@pytest.mark.parametrize(
    ("fault", "readings"),
    [
        ("gps-lost", {"fix"}),
        ("gps-frozen", {"fix"}),
        ("gps-jumped", {"fix"}),
        ("imu-frozen", {"acceleration", "rates"}),
        ("imu-biased", {"acceleration", "rates"}),
        ("magnetometer-disturbed", {"magnetic"}),
        ("magnetometer-frozen", {"magnetic"}),
        ("barometer-blocked", {"altitude"}),
        ("airspeed-blocked", {"airspeed"}),
        ("rangefinder-lost", {"distance"}),
        ("flow-lost", {"flow"}),
        ("battery-low", {"battery"}),
    ],
)
def test_a_fault_changes_its_sensor_alone(fault, readings):
    assert changed_by(fault) == readings


def test_shaking_reaches_the_inertial_sensors():
    assert changed_by("imu-shaken") >= {"acceleration", "rates"}
    assert set(FAULTS) == {
        mark.args[0] if isinstance(mark, pytest.Mark) else mark[0]
        for mark in test_a_fault_changes_its_sensor_alone.pytestmark[0].args[1]
    } | {"imu-shaken"}


def test_a_vehicle_that_moves_shakes_its_gyroscope():
    def spread(state):
        sensors = Sensors(DEFAULT_HOME, seed=3)
        rates = [sensors.sample(state, number * 0.004).rates[0] for number in range(500)]
        return stdev(rates)

    assert spread(State()) == pytest.approx(0.003, rel=0.2)
    assert spread(State(velocity=(5.0, 0.0, 0.0))) == pytest.approx(0.024, rel=0.2)


def test_unknown_equipment_is_refused():
    with pytest.raises(InvalidArgumentError, match="there is no equipment 'sonar'"):
        Sensors(DEFAULT_HOME, equipment=["sonar"])
