"""Whole missions of each type and firmware, as the ground station observes them."""

from __future__ import annotations

from math import atan2, degrees, hypot, remainder, tau

import pytest

from mavstack.dialects import common
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.whole_flights.fleet import ALL
from tests.sim.whole_flights.legs import reached_in_order
from tests.sim.whole_flights.plans import CMD, ROUNDS

pytestmark = pytest.mark.nightly

STATE = common.MissionState
PLANE, VTOL = VehicleType.PLANE, VehicleType.VTOL
#: Distance from home at rest, in metres: a plane rolls out along its course.
HOME_WITHIN = {
    VehicleType.COPTER: 1.5,
    VehicleType.PLANE: 80.0,
    VehicleType.VTOL: 3.0,
    VehicleType.ROVER: 3.0,
    VehicleType.BOAT: 4.0,
    VehicleType.SUB: 2.0,
}
every_flight = pytest.mark.parametrize(("kind", "firmware"), ALL, ids=str)


def reports_last_item(flight) -> bool:
    """Return whether the last item is reported as reached; some types change to another mode before."""
    return not flight.plan.ardupilot or flight.kind in (VehicleType.COPTER, VehicleType.SUB, VTOL)


@every_flight
def test_downloaded_mission_equals_the_uploaded_one(still_air, kind, firmware) -> None:
    flight = still_air[kind, firmware]
    first = 1 if flight.plan.ardupilot else 0  # ArduPilot's own home
    assert list(flight.downloaded)[first:] == flight.plan.items[first:]


@every_flight
def test_items_are_reached_in_order_with_two_jumps(still_air, kind, firmware) -> None:
    flight = still_air[kind, firmware]
    expected = flight.plan.order if reports_last_item(flight) else flight.plan.order[:-1]
    assert reached_in_order(flight) == expected


@every_flight
def test_do_items_are_executed_in_each_round(still_air, kind, firmware) -> None:
    flight = still_air[kind, firmware]
    changes = [seq for seq, item in enumerate(flight.plan.items) if item.command == CMD.DO_CHANGE_SPEED]
    assert [seq for _, seq in flight.journal.reached if seq in changes] == changes * ROUNDS


@every_flight
def test_mission_current_precedes_item_reached(still_air, kind, firmware) -> None:
    journal = still_air[kind, firmware].journal
    order = reached_in_order(still_air[kind, firmware])
    current_items = iter(seq for _, seq in journal.current)
    assert all(seq in current_items for seq in order)  # a subsequence


@every_flight
def test_mission_states(still_air, kind, firmware) -> None:
    flight = still_air[kind, firmware]
    states = flight.journal.states
    assert states[:3] == [STATE.NO_MISSION, STATE.NOT_STARTED, STATE.ACTIVE]
    assert states[3] in (STATE.COMPLETE, STATE.PAUSED)


@every_flight
def test_vehicle_ends_at_home_and_disarmed(still_air, kind, firmware) -> None:
    flight = still_air[kind, firmware]
    end = next(sample for sample in flight.track if sample.time >= flight.ended)
    assert hypot(end.motion.north, end.motion.east) < HOME_WITHIN[kind]
    assert abs(end.motion.down) < 0.3
    assert not end.armed
    if kind.flies:
        assert end.on_ground
        assert flight.journal.landed_state in (0, common.MavLandedState.ON_GROUND)


@pytest.mark.parametrize("kind", list(VehicleType))
def test_ardupilot_reports_each_item_when_it_starts(still_air, kind) -> None:
    flight = still_air[kind, Firmware.ARDUPILOT]
    begun = [int(text.split()[1]) for text in flight.journal.texts if text.startswith("Mission: ")]
    assert [seq for seq in begun if seq in flight.plan.order] == flight.plan.order


@pytest.mark.parametrize("kind", [kind for kind in VehicleType if kind.flies])
def test_px4_reports_takeoff_and_landing(still_air, kind) -> None:
    texts = still_air[kind, Firmware.PX4].journal.texts
    expected = ["Armed by external command", "Executing Mission", "Takeoff detected", "Landing detected"]
    assert [text for text in texts if text in expected] == expected
    assert texts[-1] == "Disarmed by landing"


@pytest.mark.parametrize("kind", [VehicleType.COPTER, VehicleType.SUB])
def test_vehicle_faces_the_region_of_interest(still_air, kind) -> None:
    """On the way to D the vehicle faces home, the region of interest."""
    flight = still_air[kind, Firmware.ARDUPILOT]
    region = next(n for n, item in enumerate(flight.plan.items) if item.command == CMD.DO_SET_ROI_LOCATION)
    after = next(seq for seq in flight.plan.order if seq > region)
    reached = next(time for time, seq in flight.journal.reached if seq == after)
    motion = next(sample.motion for sample in flight.track if sample.time >= reached - 0.5)
    bearing = atan2(-motion.east, -motion.north)
    assert abs(degrees(remainder(motion.yaw - bearing, tau))) < 15


def test_px4_copter_turns_to_the_heading_of_an_item(still_air) -> None:
    flight = still_air[VehicleType.COPTER, Firmware.PX4]
    item = next(seq for seq, item in enumerate(flight.plan.items) if item.param4 == 90)
    for time, seq in flight.journal.reached:
        if seq == item:
            motion = next(sample.motion for sample in flight.track if sample.time >= time - 0.2)
            assert degrees(motion.yaw) == pytest.approx(90, abs=15)


@every_flight
def test_loiter_time_and_delay(still_air, kind, firmware) -> None:
    """LOITER_TIME waits six seconds, NAV_DELAY three."""
    flight = still_air[kind, firmware]
    times = {seq: time for time, seq in flight.journal.reached}
    loiter = next(n for n, item in enumerate(flight.plan.items) if item.command == CMD.NAV_LOITER_TIME)
    began = next(time for time, seq in reversed(flight.journal.current) if seq == loiter)
    assert times[loiter] - began > 5.5
    delays = [n for n, item in enumerate(flight.plan.items) if item.command == CMD.NAV_DELAY]
    for delay in delays:
        assert times[delay] - times[loiter] == pytest.approx(3, abs=0.5)
