"""The standard atmosphere."""

from __future__ import annotations

import pytest

from mavstack.simulators.atmosphere import STANDARD, Atmosphere


@pytest.mark.parametrize(
    ("altitude", "pressure", "celsius", "density"),
    [
        (0.0, 1013.25, 15.0, 1.225),
        (1000.0, 898.746, 8.5, 1.1117),
        (11_000.0, 226.32, -56.5, 0.3639),
        (15_000.0, 120.45, -56.5, 0.1937),
    ],
)
def test_values_of_the_tables(altitude, pressure, celsius, density):
    assert STANDARD.pressure_at(altitude) == pytest.approx(pressure, rel=1e-4)
    assert STANDARD.temperature_at(altitude) == pytest.approx(celsius)
    assert STANDARD.density_at(altitude) == pytest.approx(density, rel=5e-4)


def test_the_day_has_its_pressure_and_temperature():
    day = Atmosphere(sea_level=990.0, temperature=35.0)
    assert day.pressure_at(0.0) == 990.0
    assert day.density_at(0.0) < STANDARD.density_at(0.0)


def test_dynamic_pressure():
    assert STANDARD.dynamic_pressure(20.0, 0.0) == pytest.approx(2.45)
    assert STANDARD.dynamic_pressure(20.0, 3000.0) < 2.0
