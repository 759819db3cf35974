"""Faults by name and time."""

from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.simulators.faults import FAULTS, Faults


def test_a_fault_lasts_from_one_time_to_another():
    faults = Faults()
    faults.update(10.0)
    faults.inject("gps-lost", after=5.0, duration=2.0)
    seen = []
    for time in (10.0, 14.9, 15.0, 16.9, 17.0):
        faults.update(time)
        seen.append("gps-lost" in faults.active)
    assert seen == [False, False, True, True, False]


def test_a_fault_begins_at_once_and_ends_when_it_is_cleared():
    faults = Faults()
    for name in FAULTS:
        faults.inject(name)
    assert faults.active == set(FAULTS)
    faults.clear("gps-lost")
    assert faults.active == set(FAULTS) - {"gps-lost"}
    faults.clear()
    assert not faults.active


def test_wrong_faults_are_refused():
    faults = Faults()
    with pytest.raises(InvalidArgumentError, match="there is no fault 'gps'"):
        faults.inject("gps")
    with pytest.raises(InvalidArgumentError, match="there is no fault 'gps'"):
        faults.clear("gps")
    with pytest.raises(InvalidArgumentError, match="injecting gps-lost failed: after must be 0 or more"):
        faults.inject("gps-lost", after=-1.0)
    assert not faults.active
