"""Flights of a group as one swarm."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.files.plans.model import params_of
from mavstack.sim.vehicle_types import VehicleType
from mavstack.swarm.search.missions import MissionOptions
from mavstack.vehicle.group import Group
from mavstack.vehicle.swarm.launch import take_off
from tests.vehicle.world import ARDUPILOT, PX4, fly

pytestmark = pytest.mark.flight
COPTERS = [(VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4), (VehicleType.COPTER, ARDUPILOT)]


def places(group):
    return np.array(
        [
            (each.local_position.north, each.local_position.east, each.position.relative_altitude)
            for each in group
        ]
    )


@pytest.mark.nightly
def test_a_group_flies_a_formation_moves_follows_and_lands():
    async def scenario(world, _vehicle):
        group = await world.node.wait_for_vehicles(3)
        (await take_off(group, 10.0, layer_spacing=10.0)).check()
        assert await group.formation("column", spacing=10, altitude=15) > 2.0
        before = places(group)
        behind = sorted(before[0, 0] - before[:, 0])
        assert behind == pytest.approx([0.0, 10.0, 20.0], abs=1.5)
        assert await group.move(north=20) > 5.0
        assert places(group) - before == pytest.approx(np.array([[20.0, 0.0, 0.0]] * 3), abs=1.5)
        leader = next(iter(group))
        home = await leader.get_home()
        await group.goto(home.latitude, home.longitude, 15.0)
        assert places(group)[0] == pytest.approx((0.0, 0.0, 15.0), abs=1.5)
        await group.follow(leader, "line", spacing=12, duration=2)
        assert abs(places(group)[1:, 1] - places(group)[0, 1]) == pytest.approx([12.0, 12.0], abs=1.5)
        (await group.land_all()).check()
        assert not any(each.in_air for each in group)
        (await group.land_all()).check()  # on the ground it does nothing

    fly(COPTERS, scenario)


def test_a_group_searches():
    async def scenario(world, vehicle):
        group = await world.node.wait_for_vehicles(2)
        home = await vehicle.get_home()
        center = (home.latitude + 0.0005, home.longitude)
        mission = MissionOptions(altitude=15.0, layer_spacing=10.0, speed=5.0)
        plans = (await group.search("parallel", center, size=60, spacing=30, mission=mission)).check()
        assert len(plans) == 2
        assert all(each.armed for each in group)
        tops = {
            max(params_of(item)[6] for item in plan.items if item.command == 16) for plan in plans.values()
        }
        assert tops == {15.0, 25.0}

    fly(COPTERS[:2], scenario)


def test_a_group_without_vehicles_flies_nothing():
    async def scenario(_world, _vehicle):
        with pytest.raises(InvalidArgumentError, match="at least one vehicle"):
            await Group([]).move(north=1)

    fly(COPTERS[0], scenario)
