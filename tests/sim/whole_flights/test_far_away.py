"""Missions over a radio with 10 % loss and 200 ms of latency each way."""

from __future__ import annotations

from math import hypot

import pytest

from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.whole_flights.legs import legs_of, reached_in_order

pytestmark = pytest.mark.nightly

COPTER = VehicleType.COPTER
MAX_CROSS_TRACK_ERROR = 5.0
each_firmware = pytest.mark.parametrize("firmware", list(Firmware), ids=str)


@each_firmware
def test_mission_is_uploaded_completely(far_away, firmware) -> None:
    flight = far_away[COPTER, firmware]
    first = 1 if flight.plan.ardupilot else 0
    assert list(flight.downloaded)[first:] == flight.plan.items[first:]


@each_firmware
def test_mission_is_flown_to_its_end(far_away, firmware) -> None:
    flight = far_away[COPTER, firmware]
    end = flight.track[-1]
    assert hypot(end.motion.north, end.motion.east) < 1.5
    assert end.on_ground
    assert not end.armed
    # each MISSION_ITEM_REACHED is sent once and may be lost
    reached = reached_in_order(flight)
    assert reached == [seq for seq in flight.plan.order if seq in reached]
    current_items = [seq for _, seq in flight.journal.current]
    assert [seq for seq in flight.plan.order if seq in current_items] == flight.plan.order


@each_firmware
def test_cross_track_error_is_small(far_away, firmware) -> None:
    assert all(
        leg.max_cross_track_error < MAX_CROSS_TRACK_ERROR for leg in legs_of(far_away[COPTER, firmware])
    )


@each_firmware
def test_log_is_listed(far_away, firmware) -> None:
    assert far_away[COPTER, firmware].logs[-1].size > 100_000
