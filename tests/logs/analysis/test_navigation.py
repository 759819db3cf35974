"""Rules about navigation: resets of the estimator."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack.logs.analysis import Severity, analyse, flights
from tests.logs.memory_log import MemoryLog

SECONDS = np.arange(60)


def findings(resets):
    """Return the findings of a flight of PX4, armed from 10 s to 20 s and from 40 s to 50 s."""
    armed = ((SECONDS >= 10) & (SECONDS < 20)) | ((SECONDS >= 40) & (SECONDS < 50))
    tables = {
        "vehicle_status": {"TimeUS": SECONDS * 1_000_000, "arming_state": 1 + armed, "nav_state": resets * 0},
        "vehicle_local_position": {"TimeUS": SECONDS * 1_000_000, "xy_reset_counter": resets},
    }
    (flight,) = flights(MemoryLog(tables))
    return analyse(flight)


def test_resets_while_armed_are_found():
    (finding,) = findings(np.where(SECONDS < 15, 3, np.where(SECONDS < 45, 4, 5)))
    assert (finding.rule, finding.severity, finding.numbers) == (
        "estimator_resets",
        Severity.WARNING,
        {"resets": 2.0},
    )
    assert finding.time == 15.0


@pytest.mark.parametrize("at", [5, 10, 20, 30, 40])
def test_resets_while_disarmed_are_none(at):
    assert findings(np.where(at > SECONDS, 3, 4)) == []
