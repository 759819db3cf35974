from __future__ import annotations

import pytest

from mavstack.sim.msp.rates import MAX_RATE, actual_rate, betaflight_rate, inav_rate


def test_actual_rates_have_the_rate_at_full_stick_and_the_sensitivity_around_the_middle():
    assert actual_rate(1.0, 7, 67, 0) == pytest.approx(670)
    assert actual_rate(-1.0, 7, 67, 50) == pytest.approx(-670)
    assert actual_rate(0.01, 7, 67, 50) / 0.01 == pytest.approx(70, abs=4)


def test_older_rates_of_betaflight():
    assert betaflight_rate(1.0, 100, 70, 0) == pytest.approx(666.7, abs=0.1)
    assert betaflight_rate(-0.5, 100, 70, 0) == pytest.approx(-153.8, abs=0.1)
    assert betaflight_rate(1.0, 255, 99, 0) == MAX_RATE


def test_inav_rates():
    assert inav_rate(1.0, 20, 70) == pytest.approx(200)
    assert inav_rate(0.5, 20, 0) == pytest.approx(100)
    assert inav_rate(0.5, 20, 70) < 60
