"""Swarms of simulated vehicles in virtual time."""

from __future__ import annotations

import asyncio
import math

import numpy as np
import pytest

from mavstack.errors import ActionRefused, InvalidArgumentError, SwarmStopped
from mavstack.sim.vehicle_types import VehicleType
from mavstack.swarm.guard import GuardLimits
from mavstack.swarm.separation import Margins
from mavstack.vehicle.swarm import SwarmOptions
from mavstack.vehicle.swarm.launch import take_off
from tests.docs.blocks import BLOCKS
from tests.vehicle.world import ARDUPILOT, PX4, fly

COPTERS = [(VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4), (VehicleType.COPTER, ARDUPILOT)]


async def launch(world, count=3):
    """Let vehicles take off to layers."""
    group = await world.node.wait_for_vehicles(count)
    (await take_off(group, 10.0, layer_spacing=10.0)).check()
    return list(group)


def places(vehicles):
    return np.array(
        [
            (each.local_position.north, each.local_position.east, each.position.relative_altitude)
            for each in vehicles
        ]
    )


@pytest.mark.flight
@pytest.mark.nightly
def test_a_mixed_swarm_flies_a_wedge_moves_and_turns():
    async def scenario(world, _vehicle):
        vehicles = await launch(world)
        async with world.node.swarm() as swarm:
            assert swarm.vehicles == tuple(vehicles)
            await swarm.formation("wedge", spacing=10)
            before = places(vehicles)
            assert before[:, 2] == pytest.approx([10.0] * 3, abs=0.5)
            await swarm.move(north=40)
            assert places(vehicles) - before == pytest.approx(np.array([[40.0, 0.0, 0.0]] * 3), abs=1.0)
            await swarm.rotate(90)
            turned = places(vehicles)
            assert turned[1:, 1] == pytest.approx([turned[0, 1] - 7.07] * 2, abs=1.0)
            assert swarm.smallest_separation > 4.0
        await asyncio.sleep(2)
        assert {each.mode.lower() for each in vehicles} <= {"brake", "loiter", "hold", "guided"}

    fly(COPTERS, scenario)


def test_members_on_the_ground_are_refused_and_nothing_is_moved():
    async def scenario(world, vehicle):
        with pytest.raises(ActionRefused, match="not armed"):
            async with world.node.swarm(1):
                pass
        assert not vehicle.armed
        with pytest.raises(InvalidArgumentError, match="use `async with`"):
            await world.node.swarm(1).move(north=1)

    fly(COPTERS[0], scenario)


@pytest.mark.flight
def test_slots_that_are_too_near_are_refused_and_the_guard_stops_a_swarm():
    async def scenario(world, _vehicle):
        vehicles = await launch(world, 2)
        options = SwarmOptions(Margins(), guard=GuardLimits(highest=35.0))
        async with world.node.swarm(options=options) as swarm:
            before = places(vehicles)
            with pytest.raises(InvalidArgumentError, match="goals must be at least"):
                await swarm.formation("line", spacing=2.0)
            assert places(vehicles) == pytest.approx(before, abs=0.5)
            with pytest.raises(
                SwarmStopped, match=r"height of vehicle 2: 3\d\.\d m above the origin"
            ) as stopped:
                await swarm.move(up=40.0)
            assert stopped.value.systems == (2,)

    fly(COPTERS[:2], scenario)


@pytest.mark.flight
def test_a_vehicle_that_a_pilot_takes_leaves_the_swarm():
    async def scenario(world, _vehicle):
        vehicles = await launch(world)
        async with world.node.swarm() as swarm:
            await swarm.formation("line", spacing=12)
            await vehicles[1].land(wait=False)
            await swarm.move(north=20)
            assert [each.system for each in swarm.vehicles] == [1, 3]

    fly(COPTERS, scenario)


@pytest.mark.flight
def test_a_swarm_follows_a_vehicle_that_another_program_flies():
    async def scenario(world, _vehicle):
        vehicles = await launch(world)
        leader = vehicles[2]
        async with world.node.swarm(1, 2) as swarm:
            following = asyncio.create_task(swarm.follow(leader, "column", spacing=12, duration=40.0))
            await asyncio.sleep(20)
            await leader.move(north=40)
            await following
            apart = places(vehicles)
            behind = sorted(np.linalg.norm(apart[:2] - apart[2], axis=1))
            assert behind == pytest.approx([12.0, 24.0], abs=3.0)
            assert swarm.smallest_separation < 13.0  # the leader counts
            with pytest.raises(InvalidArgumentError, match="is a member"):
                await swarm.follow(vehicles[0])

    fly(COPTERS, scenario)


@pytest.mark.flight
@pytest.mark.nightly
def test_followers_avoid_a_leader_that_turns_back_through_them():
    async def scenario(world, _vehicle):
        vehicles = await launch(world)
        leader = vehicles[2]
        async with world.node.swarm(1, 2) as swarm:
            following = asyncio.create_task(swarm.follow(leader, "column", spacing=12, duration=60.0))
            await asyncio.sleep(20)
            await leader.move(north=40)
            await leader.move(north=-60)
            await asyncio.sleep(25)  # the members have reached their slots, and follow the leader
            assert math.isinf(swarm._running._course.duration)
            assert [each.vehicle for each in swarm._running._others] == [leader]
            await following
            assert swarm.smallest_separation > 3.0

    fly(COPTERS, scenario)


@pytest.mark.flight
def test_a_swarm_whose_members_have_left_flies_no_more():
    async def scenario(world, _vehicle):
        vehicles = await launch(world, 2)
        async with world.node.swarm() as swarm:
            for vehicle in vehicles:
                await vehicle.set_mode("loiter" if vehicle.system == 1 else "hold")
            await asyncio.sleep(3)
            for call in (swarm.move(north=10), swarm.formation("line"), swarm.rotate(90)):
                with pytest.raises(SwarmStopped, match="no member follows setpoints any more"):
                    await call

    fly(COPTERS[:2], scenario)


@pytest.mark.flight
def test_stop_ends_the_call_that_waits():
    async def scenario(world, _vehicle):
        vehicles = await launch(world, 2)
        async with world.node.swarm() as swarm:
            moving = asyncio.create_task(swarm.move(north=500))
            await asyncio.sleep(10)
            swarm.stop("a person walked in")
            with pytest.raises(SwarmStopped, match="a person walked in"):
                await moving
            await asyncio.sleep(5)
            assert all(abs(each.velocity.north) < 0.3 for each in vehicles)
            assert places(vehicles)[:, 0].max() < 100.0

    fly(COPTERS[:2], scenario)


@pytest.mark.flight
def test_a_program_that_is_cancelled_ends_so_though_its_vehicles_answer_no_more():
    async def scenario(world, _vehicle):
        await launch(world, 2)

        async def move():
            async with world.node.swarm() as swarm:
                await swarm.move(north=500)

        moving = asyncio.create_task(move())
        await asyncio.sleep(10)
        for each in world.simulation.vehicles:
            each.cut_off = True
        moving.cancel()
        async with asyncio.timeout(60):
            with pytest.raises(asyncio.CancelledError):
                await moving

    fly(COPTERS[:2], scenario)


@pytest.mark.flight
@pytest.mark.nightly
def test_the_program_of_the_guide_runs(capsys):
    (block,) = (each for each in BLOCKS if each.page == "guides/swarms.md" and "def fly_wedge" in each.text)
    names = {}
    exec(block.text, names)

    async def scenario(world, _vehicle):
        await names["fly_wedge"](world.node)

    fly(COPTERS, scenario)
    assert float(capsys.readouterr().out.removeprefix("never nearer than ").split()[0]) > 5.0


@pytest.mark.flight
def test_a_slot_near_the_ground_is_refused():
    async def scenario(world, _vehicle):
        await launch(world, 2)
        async with world.node.swarm() as swarm:
            with pytest.raises(InvalidArgumentError, match="the lowest one is at -"):
                await swarm.formation("sphere", altitude=5.0)

    fly(COPTERS[:2], scenario)
