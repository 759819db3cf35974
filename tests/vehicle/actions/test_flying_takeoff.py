"""A takeoff ends at its altitude: within half a metre and settled, or settled for longer beside it."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import ActionTimeout, InvalidArgumentError
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.failures.scripted_autopilot import PX4 as SCRIPTED_PX4
from tests.vehicle.failures.scripted_autopilot import run_scenario
from tests.vehicle.world import ARDUPILOT, PX4, fly


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize("altitude", [5, 20, 60])
@pytest.mark.parametrize("firmware", [PX4, ARDUPILOT])
def test_a_copter_is_at_its_altitude_when_the_call_ends(firmware, altitude):
    async def scenario(world, vehicle):
        await vehicle.arm()
        await vehicle.takeoff(altitude)
        truth = world.simulated.body.truth
        assert vehicle.position.relative_altitude == pytest.approx(altitude, abs=0.5)
        assert -truth.down == pytest.approx(altitude, abs=0.7)
        assert abs(truth.velocity_down) < 0.5

    fly((VehicleType.COPTER, firmware), scenario)


async def rise(harness, *heights, interval=0.25):
    """Let the scripted vehicle pass heights."""
    for height in heights:
        harness.autopilot.altitude = height
        await asyncio.sleep(interval)


async def takeoff(harness, altitude, tolerance=None):
    harness.autopilot.altitude = 0.0
    await asyncio.sleep(1)
    rising = asyncio.create_task(harness.vehicle.takeoff(altitude, tolerance=tolerance))
    await asyncio.sleep(4)
    return rising


def test_passing_the_altitude_is_not_reaching_it():
    async def scenario(harness):
        rising = await takeoff(harness, 5)
        await rise(harness, *(step / 4 for step in range(40)))
        assert not rising.done()
        await rise(harness, *(10 - step / 4 for step in range(19)))
        assert not rising.done()
        await rise(harness, 5.1, interval=1.6)
        assert rising.done()
        await rising

    run_scenario(scenario, autopilot=SCRIPTED_PX4)


@pytest.mark.parametrize(("settled", "seconds"), [(4.4, 7.0), (5.7, 7.0)])
def test_one_that_settles_a_little_beside_it_needs_longer(settled, seconds):
    async def scenario(harness):
        rising = await takeoff(harness, 5)
        await rise(harness, 3.0, settled, interval=3.0)
        assert not rising.done()
        await rise(harness, settled, interval=seconds - 2.5)
        await asyncio.wait_for(rising, 1)

    run_scenario(scenario, autopilot=SCRIPTED_PX4)


def test_one_that_stays_far_below_it_fails():
    async def scenario(harness):
        rising = await takeoff(harness, 5)
        await rise(harness, 3.5)
        with pytest.raises(ActionTimeout, match=r"1\.5 m to go"):
            await asyncio.wait_for(rising, 60)

    run_scenario(scenario, autopilot=SCRIPTED_PX4)


def test_a_tolerance_that_was_asked_for_decides():
    async def scenario(harness):
        rising = await takeoff(harness, 5, tolerance=1.0)
        await rise(harness, 3.0, 4.2, interval=2.0)
        assert rising.done()
        await rising

    run_scenario(scenario, autopilot=SCRIPTED_PX4)


def test_one_that_settles_outside_a_small_tolerance_fails():
    async def scenario(harness):
        rising = await takeoff(harness, 5, tolerance=0.2)
        await rise(harness, 4.7)
        with pytest.raises(ActionTimeout, match=r"0\.3 m to go"):
            await asyncio.wait_for(rising, 60)

    run_scenario(scenario, autopilot=SCRIPTED_PX4)


def test_a_tolerance_of_nothing_is_refused_before_anything_is_sent():
    async def scenario(harness):
        with pytest.raises(InvalidArgumentError, match="tolerance must be positive"):
            await harness.vehicle.takeoff(5, tolerance=0.0)

    run_scenario(scenario, autopilot=SCRIPTED_PX4)
