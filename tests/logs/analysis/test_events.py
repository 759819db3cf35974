"""Rules about what the vehicle reported, on the tables of an onboard log."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack.logs.analysis import Severity, analyse, flights
from tests.logs.memory_log import MemoryLog

SECONDS = np.arange(60) * 1_000_000


def findings(*errors):
    """Return the findings of an onboard log with errors of (second, subsystem, code)."""
    times, subsystems, codes = zip(*errors, strict=True)
    columns = {"TimeUS": np.array(times) * 1_000_000, "Subsys": subsystems, "ECode": codes}
    tables = {"ATT": {"TimeUS": SECONDS, "Roll": SECONDS * 0.0}, "ERR": columns}
    (flight,) = flights(MemoryLog(tables))
    return [(found.rule, found.severity, found.title, found.time, found.numbers) for found in analyse(flight)]


def test_errors_of_an_onboard_log():
    title = "error: subsystem 6, code 1"
    assert findings((20, 6, 1), (25, 6, 0)) == [("failsafes", Severity.WARNING, title, 20.0, {})]


@pytest.mark.parametrize("mode", [0, 5])
def test_a_mode_that_was_refused(mode):
    title = f"change to mode {mode} failed"
    assert findings((20, 10, mode)) == [
        ("mode_failures", Severity.WARNING, title, 20.0, {"mode": float(mode)})
    ]
