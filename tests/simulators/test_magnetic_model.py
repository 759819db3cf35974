"""The World Magnetic Model, at the places of its own report."""

from __future__ import annotations

import math

import pytest

from mavstack.simulators.magnetic_model import magnetic_field


@pytest.mark.parametrize(
    ("place", "nanotesla"),
    [
        ((80.0, 0.0), (6521.6, 145.9, 54791.5)),
        ((0.0, 120.0), (39677.8, -109.6, -10580.2)),
        ((-80.0, 240.0), (6117.5, 15751.9, -52022.5)),
    ],
)
def test_values_of_the_report(place, nanotesla):
    field = magnetic_field(*place, year=2025.0)
    assert [value * 1e5 for value in field] == pytest.approx(nanotesla, abs=0.1)


def test_the_field_falls_with_altitude_and_changes_with_time():
    ground, high = magnetic_field(47.4, 8.5), magnetic_field(47.4, 8.5, 100_000.0)
    assert 0.93 < math.hypot(*high) / math.hypot(*ground) < 0.97
    assert magnetic_field(47.4, 8.5, year=2029.0) != ground


@pytest.mark.parametrize("latitude", [90.0, -90.0])
def test_the_poles_have_a_field(latitude):
    assert 0.5 < math.hypot(*magnetic_field(latitude, 0.0)) < 0.7
