"""Errors of one sensor."""

from __future__ import annotations

from random import Random
from statistics import stdev

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.simulators.sensor_model import SensorChannel, SensorModel, SensorModels


def channel(size=1, seed=1, **errors):
    return SensorChannel(SensorModel(**errors), Random(seed).gauss, size)


def test_a_bias_is_constant():
    assert channel(bias=2.0).measure(0.0, (1.0,)) == (3.0,)
    assert channel(3, bias=(1.0, 2.0, 3.0)).measure(0.0, (0.0, 0.0, 0.0)) == (1.0, 2.0, 3.0)
    with pytest.raises(InvalidArgumentError, match="must have 3 axes, got 2"):
        channel(3, bias=(1.0, 2.0))


def test_a_delay_is_a_shift_in_time():
    made = channel(delay=0.02)
    values = [made.measure(index * 0.004, (float(index),))[0] for index in range(20)]
    assert values == [0.0] * 5 + [float(index - 5) for index in range(5, 20)]


@pytest.mark.properties
@given(st.floats(1, 400), st.floats(0.0005, 0.02))
def test_a_rate_is_kept_on_average(rate, step):
    made = channel(rate=rate)
    count = sum(made.measure(index * step, (0.0,)) is not None for index in range(1000))
    wanted = min(1000.0, 999 * step * rate + 1)
    assert abs(count - wanted) <= 1.01


def test_drift_grows_by_the_root_of_the_time():
    ends = []
    for seed in range(300):
        made = channel(seed=seed, drift=0.1)
        made.measure(0.0, (0.0,))
        ends.append(made.measure(4.0, (0.0,))[0])
    assert stdev(ends) == pytest.approx(0.2, rel=0.15)


@pytest.mark.parametrize("errors", [{"noise": -1.0}, {"rate": float("nan")}, {"delay": float("inf")}])
def test_a_wrong_number_is_refused(errors):
    with pytest.raises(InvalidArgumentError, match="of a sensor must be 0 or more"):
        SensorModel(**errors)


def test_ideal_sensors_keep_their_rates():
    ideal = SensorModels.ideal()
    assert ideal.position == SensorModel(rate=10.0)
    assert ideal.gyroscope == SensorModel()
