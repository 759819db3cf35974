"""Whole missions of each type and firmware, as the ground station observes them."""

from __future__ import annotations

from math import atan2, degrees, hypot, remainder, tau

import pytest

from mavstack.dialects import common
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.whole_flights.fleet import ALL
from tests.sim.whole_flights.legs import reached_in_order
from tests.sim.whole_flights.plans import CMD, ROUNDS

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


def last_counts(flight) -> bool:
    """Return whether the last item is reported as reached: some leave it for another mode before."""
    return not flight.plan.ardupilot or flight.kind in (VehicleType.COPTER, VehicleType.SUB, VTOL)


@every_flight
def test_the_mission_on_board_is_the_one_sent(calm, kind, firmware) -> None:
    flight = calm[kind, firmware]
    first = 1 if flight.plan.ardupilot else 0  # ArduPilot's own home
    assert list(flight.downloaded)[first:] == flight.plan.items[first:]


@every_flight
def test_items_are_reached_in_their_order_with_two_jumps_back(calm, kind, firmware) -> None:
    flight = calm[kind, firmware]
    expected = flight.plan.order if last_counts(flight) else flight.plan.order[:-1]
    assert reached_in_order(flight) == expected


@every_flight
def test_what_the_middle_does_is_done_in_each_round(calm, kind, firmware) -> None:
    flight = calm[kind, firmware]
    changes = [seq for seq, item in enumerate(flight.plan.items) if item.command == CMD.DO_CHANGE_SPEED]
    assert [seq for _, seq in flight.journal.reached if seq in changes] == changes * ROUNDS


@every_flight
def test_the_current_item_is_told_before_it_is_reached(calm, kind, firmware) -> None:
    journal = calm[kind, firmware].journal
    order = reached_in_order(calm[kind, firmware])
    told = iter(seq for _, seq in journal.current)
    assert all(seq in told for seq in order)  # a subsequence


@every_flight
def test_the_state_of_the_mission_is_told(calm, kind, firmware) -> None:
    flight = calm[kind, firmware]
    states = flight.journal.states
    assert states[:3] == [STATE.NO_MISSION, STATE.NOT_STARTED, STATE.ACTIVE]
    assert states[3] in (STATE.COMPLETE, STATE.PAUSED)


@every_flight
def test_it_is_home_and_disarmed_in_the_end(calm, kind, firmware) -> None:
    flight = calm[kind, firmware]
    end = next(sample for sample in flight.track if sample.time >= flight.ended)
    assert hypot(end.motion.north, end.motion.east) < HOME_WITHIN[kind]
    assert abs(end.motion.down) < 0.3
    assert not end.armed
    if kind.flies:
        assert end.on_ground
        assert flight.journal.landed_state in (0, common.MavLandedState.ON_GROUND)


@pytest.mark.parametrize("kind", list(VehicleType))
def test_ardupilot_says_each_item_as_it_begins(calm, kind) -> None:
    flight = calm[kind, Firmware.ARDUPILOT]
    begun = [int(text.split()[1]) for text in flight.journal.texts if text.startswith("Mission: ")]
    assert [seq for seq in begun if seq in flight.plan.order] == flight.plan.order


@pytest.mark.parametrize("kind", [kind for kind in VehicleType if kind.flies])
def test_px4_says_that_it_took_off_and_landed(calm, kind) -> None:
    texts = calm[kind, Firmware.PX4].journal.texts
    wanted = ["Armed by external command", "Executing Mission", "Takeoff detected", "Landing detected"]
    assert [text for text in texts if text in wanted] == wanted
    assert texts[-1] == "Disarmed by landing"


@pytest.mark.parametrize("kind", [VehicleType.COPTER, VehicleType.SUB])
def test_the_nose_looks_at_the_region_of_interest(calm, kind) -> None:
    """On the way to D the vehicle faces home, the region of interest."""
    flight = calm[kind, Firmware.ARDUPILOT]
    region = next(n for n, item in enumerate(flight.plan.items) if item.command == CMD.DO_SET_ROI_LOCATION)
    after = next(seq for seq in flight.plan.order if seq > region)
    reached = next(time for time, seq in flight.journal.reached if seq == after)
    motion = next(sample.motion for sample in flight.track if sample.time >= reached - 0.5)
    towards = atan2(-motion.east, -motion.north)
    assert abs(degrees(remainder(motion.yaw - towards, tau))) < 15


def test_a_px4_copter_turns_to_the_heading_of_an_item(calm) -> None:
    flight = calm[VehicleType.COPTER, Firmware.PX4]
    item = next(seq for seq, item in enumerate(flight.plan.items) if item.param4 == 90)
    for time, seq in flight.journal.reached:
        if seq == item:
            motion = next(sample.motion for sample in flight.track if sample.time >= time - 0.2)
            assert degrees(motion.yaw) == pytest.approx(90, abs=15)


@every_flight
def test_it_waits_where_it_is_told_to(calm, kind, firmware) -> None:
    """LOITER_TIME waits six seconds, NAV_DELAY three."""
    flight = calm[kind, firmware]
    times = {seq: time for time, seq in flight.journal.reached}
    loiter = next(n for n, item in enumerate(flight.plan.items) if item.command == CMD.NAV_LOITER_TIME)
    began = next(time for time, seq in reversed(flight.journal.current) if seq == loiter)
    assert times[loiter] - began > 5.5
    delays = [n for n, item in enumerate(flight.plan.items) if item.command == CMD.NAV_DELAY]
    for delay in delays:
        assert times[delay] - times[loiter] == pytest.approx(3, abs=0.5)
