"""A mission that ends with a return is over when the vehicle is home, and can be flown again."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, Plan
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.world import ARDUPILOT, PX4, fly, kind_name

CMD = common.MavCmd
COPTERS = [(VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4)]


def there_and_back(world, firmware):
    frame = world.simulated.body.frame

    def item(command, north, up):
        latitude, longitude, _ = frame.to_global(north, 0.0, 0.0)
        return MissionItem(command, param5=latitude, param6=longitude, param7=up)

    home = [item(CMD.NAV_WAYPOINT, 0.0, 0.0)] if firmware is ARDUPILOT else []
    returning = MissionItem(CMD.NAV_RETURN_TO_LAUNCH, frame=common.MavFrame.MISSION)
    flown = [item(CMD.NAV_TAKEOFF, 0.0, 10.0), item(CMD.NAV_WAYPOINT, 25.0, 10.0), returning]
    return Plan.of([*home, *flown])


@pytest.mark.nightly
@pytest.mark.parametrize("kind", COPTERS, ids=kind_name)
def test_it_ends_when_the_vehicle_returned_and_can_be_flown_again(kind):
    async def scenario(world, vehicle):
        await vehicle.mission.upload(there_and_back(world, kind[1]))
        for _ in range(2):
            async with vehicle.mission.reached_items() as items:
                await vehicle.mission.fly()
                reached = [each.seq for each in items.drain()]
            assert not world.simulated.autopilot.armed
            assert -world.simulated.body.truth.down < 0.5
            assert reached == sorted(set(reached))  # each once, though PX4 says each eleven times
            assert len(reached) >= 2

    fly(kind, scenario)


@pytest.mark.nightly
def test_an_older_version_that_does_not_report_the_item_count():
    async def scenario(world, vehicle):
        server = world.simulated.mission
        server.current_message = lambda: common.MissionCurrent(seq=server.current)
        await vehicle.mission.upload(there_and_back(world, ARDUPILOT))
        async with vehicle.mission.reached_items() as items:
            await vehicle.mission.fly()
            assert {1, 2} <= {each.seq for each in items.drain()}
        assert not world.simulated.autopilot.armed

    fly(COPTERS[0], scenario)
