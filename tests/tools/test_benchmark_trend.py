"""The verdict of the benchmark of growth: a slope counts if the noise does not explain it."""

from __future__ import annotations

import random

from benchmarks.station.trend import MIN_VALUES, trend


def noisy(slope: float, noise: float, count: int = 25, seed: int = 1) -> list[float]:
    numbers = random.Random(seed)
    return [100 + slope * minute + numbers.gauss(0, noise) for minute in range(count)]


def test_a_steady_figure_does_not_grow() -> None:
    assert not trend([100.0] * 25).grows
    assert not trend(noisy(slope=0, noise=3)).grows


def test_growth_beyond_the_noise_is_found() -> None:
    found = trend(noisy(slope=0.5, noise=1))
    assert found.grows
    assert found.low < 0.5 < found.high


def test_the_interval_holds_the_growth_in_95_of_100_cases() -> None:
    trends = [trend(noisy(slope=0.5, noise=2, seed=seed)) for seed in range(400)]
    held = sum(each.low <= 0.5 <= each.high for each in trends)
    assert 0.92 < held / len(trends) < 0.98


def test_odd_values_do_not_move_the_growth() -> None:
    values = noisy(slope=0, noise=1)
    values[-2:] = [400, 400]
    assert not trend(values).grows
    values = noisy(slope=0.5, noise=1)
    values[-1] = 0
    assert trend(values).grows


def test_growth_within_the_noise_is_none() -> None:
    assert not trend(noisy(slope=0.2, noise=20)).grows


def test_growth_within_the_tolerance_is_none() -> None:
    assert not trend(noisy(slope=0.05, noise=0)).grows
    assert trend(noisy(slope=0.2, noise=0)).grows


def test_a_few_values_prove_nothing() -> None:
    for count in range(2, MIN_VALUES):
        assert not trend(noisy(slope=100, noise=0, count=count)).grows
    assert trend(noisy(slope=100, noise=0, count=MIN_VALUES)).grows
