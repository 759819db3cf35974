"""End of a PX4 mission whose last item is a return, as in SITL."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.test_mission_ends import there_and_back
from tests.vehicle.world import PX4, fly

COPTER = (VehicleType.COPTER, PX4)


@pytest.mark.nightly
def test_mission_is_finished_when_the_return_begins():
    async def scenario(world, vehicle):
        states, reached, texts = [], [], []
        vehicle.add_listener(
            common.MissionCurrent, lambda message: states.append((message.seq, message.mission_state))
        )
        vehicle.add_listener(common.MissionItemReached, lambda message: reached.append(message.seq))
        vehicle.add_listener(common.Statustext, lambda message: texts.append(message.text.rstrip()))
        await vehicle.mission.upload(there_and_back(world, PX4))
        await vehicle.mission.fly()
        await asyncio.sleep(2)
        start = texts.index("Mission finished, loitering")
        assert texts[start + 1] == "Returning to launch"
        assert texts[start + 2].startswith("RTL: start return")
        assert (2, common.MissionState.COMPLETE) in states
        assert vehicle.mode == "LOITER"  # not MISSION, which would restart at the next arming

    fly(COPTER, scenario)


@pytest.mark.nightly
def test_mission_item_reached_is_repeated_ten_times():
    async def scenario(world, vehicle):
        reached = []
        vehicle.add_listener(common.MissionItemReached, lambda message: reached.append(message.seq))
        await vehicle.mission.upload(there_and_back(world, PX4))
        await vehicle.mission.fly()
        await asyncio.sleep(15)
        assert reached == sorted(reached)
        assert reached.count(0) > 1
        assert reached.count(2) == 11

    fly(COPTER, scenario)
