"""The region of interest: where simulated vehicles look, and the requests to each firmware."""

from __future__ import annotations

from math import degrees

import pytest

from mavstack.errors import ActionUnsupported, InvalidArgumentError
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT as ARDUPILOT_NUMBER
from tests.vehicle.failures.scripted_autopilot import CMD, RESULT, run_scenario
from tests.vehicle.firmware.received_requests import INT, LONG, THERE, requests_of
from tests.vehicle.world import ARDUPILOT, PX4, fly


@pytest.mark.parametrize("firmware", [ARDUPILOT, PX4])
def test_the_gimbal_keeps_pointing_at_a_location(firmware):
    async def scenario(world, vehicle):
        payload = world.simulated.autopilot.payload
        east = world.simulated.body.frame.to_global(0.0, 50.0, 0.0)[:2]
        await vehicle.roi.set_location(*east)
        await world.wait_until(lambda: abs(degrees(payload.gimbal.yaw) - 90) < 3)
        assert payload.region_of_interest == pytest.approx((0, 50, 0), abs=1.5)
        await vehicle.roi.clear()
        assert payload.region_of_interest is None

    fly((VehicleType.COPTER, firmware), scenario)


def test_px4_counts_the_altitude_from_the_sea():
    async def scenario(harness):
        await harness.vehicle.get_home()
        harness.autopilot.received.clear()
        await harness.vehicle.roi.set_location(*THERE, 12)
        await harness.vehicle.roi.set_next_waypoint(pitch=-30, yaw=15)
        assert requests_of(harness) == [
            (INT, "DO_SET_ROI_LOCATION", "GLOBAL", 0, 0, 0, 0, *THERE, 500),
            (LONG, "DO_SET_ROI_WPNEXT_OFFSET", 0, 0, 0, 0, -30, 0, 15),
        ]

    run_scenario(scenario)


def test_ardupilot_counts_the_altitude_from_home():
    async def scenario(harness):
        await harness.vehicle.roi.set_location(*THERE, 12)
        await harness.vehicle.roi.clear()
        assert requests_of(harness) == [
            (INT, "DO_SET_ROI_LOCATION", "GLOBAL_RELATIVE_ALT", 0, 0, 0, 0, *THERE, 12),
            (LONG, "DO_SET_ROI_NONE", 0, 0, 0, 0, 0, 0, 0),
        ]
        with pytest.raises(ActionUnsupported, match="cannot look at its next waypoint"):
            await harness.vehicle.roi.set_next_waypoint()

    run_scenario(scenario, autopilot=ARDUPILOT_NUMBER)


def test_older_versions_of_ardupilot_clear_it_by_a_location_of_zeros():
    async def scenario(harness):
        harness.autopilot.refuse(CMD.DO_SET_ROI_NONE, result=RESULT.UNSUPPORTED)
        await harness.vehicle.roi.clear()
        zeros = [0] * 7
        assert requests_of(harness)[-1] == (INT, "DO_SET_ROI_LOCATION", "GLOBAL_RELATIVE_ALT", *zeros)

    run_scenario(scenario, autopilot=ARDUPILOT_NUMBER)


def test_a_place_that_is_not_on_earth():
    async def scenario(harness):
        with pytest.raises(InvalidArgumentError, match="latitude"):
            await harness.vehicle.roi.set_location(91, 8)
        assert requests_of(harness) == []

    run_scenario(scenario)
