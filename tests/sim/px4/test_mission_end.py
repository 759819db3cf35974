"""How a mission of PX4's ends that ends with a return, as a running PX4 does it."""

from __future__ import annotations

import asyncio

from mavstack.dialects import common
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.test_mission_ends import there_and_back
from tests.vehicle.world import PX4, fly

COPTER = (VehicleType.COPTER, PX4)


def test_it_is_finished_when_it_begins_to_return():
    async def scenario(world, vehicle):
        states, reached, texts = [], [], []
        vehicle.add_listener(
            common.MissionCurrent, lambda message: states.append((message.seq, message.mission_state))
        )
        vehicle.add_listener(common.MissionItemReached, lambda message: reached.append(message.seq))
        vehicle.add_listener(common.Statustext, lambda message: texts.append(message.text))
        await vehicle.mission.upload(there_and_back(world, PX4))
        await vehicle.mission.fly()
        await asyncio.sleep(2)
        begun = texts.index("Mission finished, loitering")
        assert texts[begun + 1] == "Returning to launch"
        assert texts[begun + 2].startswith("RTL: start return")
        assert (2, common.MissionState.COMPLETE) in states
        assert vehicle.mode == "LOITER"  # and not MISSION, which would begin anew when it is armed

    fly(COPTER, scenario)


def test_what_was_reached_is_said_again_ten_times_or_until_something_else_is():
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
