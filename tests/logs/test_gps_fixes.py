"""Fixes as fingerprints: only those of a short time."""

from __future__ import annotations

import pytest

from mavstack.logs.gps_fixes import gps_fixes
from tests.logs.memory_log import MemoryLog


def test_a_position_that_returns_later_is_no_fingerprint():
    places = [(0, 47.0), (1, 47.1), (2, 47.1), (3, 47.2), (60, 47.0)]
    gps = {
        "TimeUS": [second * 1_000_000 for second, _ in places],
        "Lat": [latitude for _, latitude in places],
        "Lng": [8.5] * len(places),
    }
    keys, times = gps_fixes(MemoryLog({"GPS": gps}), "boot")
    assert sorted(times.tolist()) == pytest.approx([1.0, 3.0])
    assert len(set(keys.tolist())) == 2


@pytest.mark.parametrize("latitude", [float("nan"), float("inf"), 91.0, 0.0])
def test_a_position_that_is_none_is_no_fingerprint(latitude):
    gps = {"TimeUS": [1], "Lat": [latitude], "Lng": [0.0]}
    keys, _ = gps_fixes(MemoryLog({"GPS": gps}), "boot")
    assert len(keys) == 0
