"""A takeoff of a vehicle that takes off or flies already, and one that fails on its way."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted, ActionRefused, ActionTimeout, ContactLost, HealthTimeout
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT as SCRIPTED_ARDUPILOT
from tests.vehicle.failures.scripted_autopilot import run_scenario
from tests.vehicle.world import ARDUPILOT, fly

PLANE = common.MavType.FIXED_WING
ACTING = (common.CommandLong, common.CommandInt, common.SetMode, common.ParamSet)


async def stand(harness, altitude=0.0):
    """Let the scripted plane stand on the ground with TKOFF_ALT 50."""
    harness.autopilot.parameters.add("TKOFF_ALT", 50.0)
    harness.autopilot.altitude = altitude
    harness.autopilot.land()
    harness.autopilot.enter("FLY_BY_WIRE_A")
    await asyncio.sleep(1)


def takeoff_altitude(harness):
    return harness.autopilot.parameters.table["TKOFF_ALT"].value


def acted(harness):
    return [message for message in harness.autopilot.received if isinstance(message, ACTING)]


@pytest.mark.parametrize("kind", [VehicleType.PLANE, VehicleType.COPTER, VehicleType.VTOL])
def test_a_takeoff_in_the_air_is_refused_before_anything_is_sent(kind):
    async def scenario(world, vehicle):
        await vehicle.arm()
        await vehicle.takeoff(40)
        values = {name: each.value for name, each in world.simulated.parameters.table._definitions.items()}
        mode = vehicle.mode
        with pytest.raises(ActionRefused, match=r"go to another altitude by goto\(\) or move\(\)"):
            await vehicle.takeoff(60)
        await asyncio.sleep(2)
        assert vehicle.mode == mode
        assert values == {
            name: each.value for name, each in world.simulated.parameters.table._definitions.items()
        }

    fly((kind, ARDUPILOT), scenario)


def test_a_second_takeoff_to_the_same_altitude_waits_for_it():
    async def scenario(world, vehicle):
        await vehicle.arm()
        await vehicle.takeoff(40, wait=False)
        await asyncio.sleep(3)
        await vehicle.takeoff(40)
        assert vehicle.position.relative_altitude > 35

    fly((VehicleType.PLANE, ARDUPILOT), scenario)


def test_a_takeoff_that_stalls_restores_the_altitude_of_takeoffs():
    async def scenario(harness):
        await stand(harness)
        with pytest.raises(ActionTimeout) as stalled:
            await harness.vehicle.takeoff(80, timeout=20)
        assert takeoff_altitude(harness) == 50
        assert harness.vehicle.mode == "TAKEOFF"  # it may be on its way
        assert stalled.value.not_restored == ()

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, kind=PLANE)


def test_an_interrupted_takeoff_restores_it_too():
    async def scenario(harness):
        await stand(harness)
        rising = asyncio.create_task(harness.vehicle.takeoff(80))
        await asyncio.sleep(4)
        assert takeoff_altitude(harness) == 80
        harness.autopilot.enter("CRUISE")
        with pytest.raises(ActionInterrupted):
            await rising
        assert takeoff_altitude(harness) == 50

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, kind=PLANE)


def test_a_takeoff_without_contact_names_what_stays_changed():
    async def scenario(harness):
        await stand(harness)
        rising = asyncio.create_task(harness.vehicle.takeoff(80))
        await asyncio.sleep(4)
        harness.autopilot.silent = True
        with pytest.raises(ContactLost) as lost:
            await rising
        assert lost.value.not_restored == ("parameter TKOFF_ALT 50",)

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, kind=PLANE)


def test_an_altitude_above_the_sea_before_home_is_known_is_no_takeoff():
    async def scenario(harness):
        await stand(harness, altitude=488.0)
        rising = asyncio.create_task(harness.vehicle.takeoff(40, timeout=20))
        await asyncio.sleep(8)
        assert not rising.done()
        harness.autopilot.landed = common.MavLandedState.IN_AIR
        harness.autopilot.altitude = 39.0
        await asyncio.wait_for(rising, 5)

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, kind=PLANE)


def test_a_mode_that_the_vehicle_left_by_itself_is_not_called_unrestored():
    async def scenario(harness):
        harness.autopilot.arm(False)
        harness.autopilot.enter("INITIALIZING")
        harness.autopilot.ready = False
        await asyncio.sleep(1)
        asyncio.get_running_loop().call_later(3, harness.autopilot.enter, "MANUAL")
        with pytest.raises(HealthTimeout) as late:
            await harness.vehicle.wait_until_ready(timeout=8, keep_mode=True)
        assert late.value.not_restored == ()

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, kind=PLANE)
