"""The spectrum of the accelerations."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack.logs.analysis import flights
from mavstack.logs.analysis.spectrum import acceleration_spectrum
from tests.logs.memory_log import MemoryLog

RATE, SECONDS = 400, 8
TIMES = np.arange(RATE * SECONDS) / RATE
STILL = np.zeros(len(TIMES))


def spectrum(accelerations, *, rate=RATE, **tables):
    """Return the spectrum of accelerations along x, sampled at a rate."""
    times = np.arange(len(accelerations)) / rate
    columns = {"TimeUS": (times * 1e6).round(), "AccX": accelerations, "AccY": 0.0, "AccZ": -9.81}
    (flight,) = flights(MemoryLog({"ACC": columns} | tables))
    return acceleration_spectrum(flight)


@pytest.mark.parametrize("hertz", [25.0, 80.0, 150.0])
def test_a_vibration_is_a_peak_of_its_frequency_and_amplitude(hertz):
    found = spectrum(3.0 * np.sin(2 * np.pi * hertz * TIMES))
    x, y, z = found.amplitudes
    assert (found.source, found.rate) == ("ACC", pytest.approx(RATE))
    assert found.frequencies[x.argmax()] == pytest.approx(hertz, abs=RATE / 512)
    assert x.max() == pytest.approx(3.0, rel=0.15)
    assert (y.max(), z.max()) == (pytest.approx(0, abs=1e-9), pytest.approx(0, abs=1e-9)), "gravity is none"


def test_only_the_flight_counts():
    shaken = np.where(TIMES < 4, 0.0, 50 * np.sin(2 * np.pi * 60 * TIMES))
    states = {"TimeUS": [0, 4_000_000], "ArmState": [1, 0]}
    assert spectrum(shaken).amplitudes[0].max() > 20
    assert spectrum(shaken, ARM=states).amplitudes[0].max() == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(
    ("accelerations", "rate"),
    [(STILL, 10), (STILL[:500], RATE), (np.where(TIMES == 1.0, np.nan, 0.0), RATE)],
    ids=["slow", "short", "damaged"],
)
def test_data_that_do_not_allow_a_spectrum(accelerations, rate):
    assert spectrum(accelerations, rate=rate) is None


def test_a_log_without_accelerations():
    (flight,) = flights(MemoryLog({"ATT": {"TimeUS": [1, 2], "Roll": [0.0, 1.0]}}))
    assert acceleration_spectrum(flight) is None
