"""Rovers that brake, stop or pass beside the place at which a call ends."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionTimeout
from mavstack.geodesy import offset_location
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT, run_scenario

HERE = (47.397742, 8.545594)


def drive(harness, *ways, interval=0.25):
    """Let the scripted rover be at distances in metres south of the place `HERE`, one after the other."""

    async def go():
        for away in ways:
            harness.autopilot.speed = 2.0 if away != ways[-1] else 0.0
            harness.autopilot.latitude = offset_location(*HERE, -away, 0.0)[0]
            harness.autopilot.longitude = HERE[1]
            await asyncio.sleep(interval)

    return go()


def test_a_rover_that_brakes_behind_its_radius_has_arrived():
    """A real ArduRover enters WP_RADIUS at speed and stands 0.8 m behind it."""

    async def scenario(harness):
        harness.autopilot.parameters.add("WP_RADIUS", 3.0)
        await drive(harness, 20.0, interval=1.0)
        going = asyncio.create_task(harness.vehicle.goto(*HERE))
        await drive(harness, *(18.0 - step for step in range(18)), -1.0, -2.5, -3.8, interval=0.5)
        await asyncio.sleep(2.0)
        assert not going.done()
        await asyncio.wait_for(going, 5)

    run_scenario(scenario, autopilot=ARDUPILOT, kind=common.MavType.GROUND_ROVER)


@pytest.mark.parametrize(("stand", "options"), [(4.0, {}), (-3.8, {"tolerance": 3.0}), (-9.5, {})])
def test_a_rover_that_stops_elsewhere_has_not(stand, options):
    """Before it came near, farther away than it brakes, or with a tolerance that was asked for."""

    async def scenario(harness):
        harness.autopilot.parameters.add("WP_RADIUS", 3.0)
        await drive(harness, 20.0, interval=1.0)
        going = asyncio.create_task(harness.vehicle.goto(*HERE, **options))
        steps = [18.0 - step for step in range(30) if 18.0 - step > stand]
        await drive(harness, *steps, stand, interval=0.5)
        with pytest.raises(ActionTimeout, match="m away, the tolerance is 3 m"):
            await asyncio.wait_for(going, 60)

    run_scenario(scenario, autopilot=ARDUPILOT, kind=common.MavType.GROUND_ROVER)


async def miss(harness, away):
    """Let the rover pass the place, stand beside it, and report the end of its drive as ArduRover does."""
    await drive(harness, 12.0, 6.0, away, interval=0.5)
    harness.autopilot.send(common.MissionItemReached(seq=0))
    await asyncio.sleep(5.0)


def repositions(harness):
    return [
        m for m in harness.autopilot.received if getattr(m, "command", None) == common.MavCmd.DO_REPOSITION
    ]


def test_a_rover_that_passed_the_place_far_beside_it_is_sent_there_again():
    async def scenario(harness):
        harness.autopilot.parameters.add("WP_RADIUS", 2.0)
        await drive(harness, 20.0, interval=1.0)
        going = asyncio.create_task(harness.vehicle.goto(*HERE, timeout=60))
        await miss(harness, -3.6)
        assert len(repositions(harness)) == 2
        await drive(harness, -2.0, -1.0, interval=0.5)
        await asyncio.wait_for(going, 5)

    run_scenario(scenario, autopilot=ARDUPILOT, kind=common.MavType.GROUND_ROVER)


def test_a_rover_that_always_passes_the_place_fails_with_the_reason():
    async def scenario(harness):
        harness.autopilot.parameters.add("WP_RADIUS", 2.0)
        await drive(harness, 20.0, interval=1.0)
        going = asyncio.create_task(harness.vehicle.goto(*HERE))
        for _ in range(3):
            await miss(harness, -3.6)
        with pytest.raises(
            ActionTimeout, match=r"passed the location and stopped 3\.60 m away.*larger tolerance"
        ):
            await asyncio.wait_for(going, 5)
        assert len(repositions(harness)) == 3

    run_scenario(scenario, autopilot=ARDUPILOT, kind=common.MavType.GROUND_ROVER)


def test_a_rover_that_stops_within_the_radius_of_its_firmware_fails_soon_with_the_parameter():
    """A real ArduRover with WP_RADIUS 2 stands 0.6 m from a place, and no second request moves it."""

    async def scenario(harness):
        await drive(harness, 20.0, interval=1.0)  # it does not report WP_RADIUS
        going = asyncio.create_task(harness.vehicle.goto(*HERE, tolerance=0.5))
        await drive(harness, 12.0, 6.0, 0.6, interval=0.5)
        harness.autopilot.send(common.MissionItemReached(seq=0))
        reason = (
            r"it ended its drive 0\.60 m away, the tolerance is 0\.5 m; "
            r"it stops within WP_RADIUS, usually 2 m; "
            r"set that parameter, or allow a larger tolerance"
        )
        with pytest.raises(ActionTimeout, match=reason):
            await asyncio.wait_for(going, 5)
        assert len(repositions(harness)) == 1

    run_scenario(scenario, autopilot=ARDUPILOT, kind=common.MavType.GROUND_ROVER)


def test_a_rover_without_reports_that_stops_within_the_radius_names_the_parameter():
    async def scenario(harness):
        await drive(harness, 20.0, interval=1.0)
        going = asyncio.create_task(harness.vehicle.goto(*HERE, tolerance=0.5))
        await drive(harness, 12.0, 6.0, 0.6, interval=0.5)
        with pytest.raises(
            ActionTimeout, match=r"it is 0\.60 m away.*it stops within WP_RADIUS, usually 2 m"
        ):
            await asyncio.wait_for(going, 60)

    run_scenario(scenario, autopilot=ARDUPILOT, kind=common.MavType.GROUND_ROVER)
