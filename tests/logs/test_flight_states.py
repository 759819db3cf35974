"""Armed or not, and the flight mode, at any time of a log."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.logs.flight_states import States, flight_states
from tests.logs.files import encoded, stamped
from tests.logs.flights import ARMED_AT, DISARMED_AT, LAND_AT


def test_states_of_a_packet_log(flight):
    states = flight_states(flight)
    assert set(states) == {1, 2}, "a ground station has no states"
    start = flight.times("HEARTBEAT")[0]
    seconds = start + np.arange(10) + 0.05
    assert np.flatnonzero(states[1].armed.at(seconds)).tolist() == list(range(ARMED_AT, DISARMED_AT))
    assert states[1].mode.at(seconds).tolist() == ["STABILIZE"] * LAND_AT + ["LAND"] * (10 - LAND_AT)
    spans = states[1].mode.spans(start + 10)
    assert [(span.value, round(span.duration, 3)) for span in spans] == [("STABILIZE", 6.0), ("LAND", 4.0)]
    assert [span.value for span in states[1].armed.spans(start + 10)] == [False, True, False]


def test_a_mode_without_a_name_is_its_number(tmp_path):
    path = tmp_path / "mode.tlog"
    beat = common.Heartbeat(type=2, autopilot=3, custom_mode=250)
    other = common.Heartbeat(type=2, autopilot=0, custom_mode=7)
    path.write_bytes(stamped(encoded([beat]) + encoded([other], system=2)))
    states = flight_states(open_log(path, "common"))
    assert states[1].mode.values.tolist() == ["250"]
    assert states[2].mode.values.tolist() == ["7"]


def test_states_before_the_first_record_and_without_records():
    states = States(np.array([5.0]), np.array([True]), default=False)
    assert states.at(np.array([4.0, 5.0, 6.0])).tolist() == [False, True, True]
    none: States[bool] = States(np.empty(0), np.empty(0, np.bool_), default=False)
    assert none.at(np.array([1.0])).tolist() == [False]
    assert none.spans(9.0) == []


@pytest.mark.parametrize("end", [3.0, 7.0])
def test_the_last_span_ends_with_the_log(end):
    states = States(np.array([1.0, 2.0, 4.0]), np.array(["A", "A", "B"], object), default="")
    assert states.spans(end) == [(1.0, 4.0, "A"), (4.0, max(end, 4.0), "B")]
