"""The verdict of the benchmark of growth: a slope counts if the noise does not explain it."""

from __future__ import annotations

import random

from benchmarks.station.trend import trend


def noisy(slope: float, noise: float, count: int = 25) -> list[float]:
    numbers = random.Random(1)
    return [100 + slope * minute + numbers.gauss(0, noise) for minute in range(count)]


def test_a_steady_figure_does_not_grow() -> None:
    assert not trend([100.0] * 25).grows
    assert not trend(noisy(slope=0, noise=3)).grows


def test_growth_beyond_the_noise_is_found() -> None:
    found = trend(noisy(slope=0.5, noise=1))
    assert found.grows
    assert abs(found.slope - 0.5) < 2 * found.error


def test_growth_within_the_noise_is_none() -> None:
    assert not trend(noisy(slope=0.2, noise=20)).grows


def test_growth_within_the_tolerance_is_none() -> None:
    assert not trend(noisy(slope=0.05, noise=0)).grows
    assert trend(noisy(slope=0.2, noise=0)).grows


def test_two_values_prove_nothing() -> None:
    assert not trend([100.0, 200.0]).grows
