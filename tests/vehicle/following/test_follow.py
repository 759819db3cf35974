"""Vehicles that follow a leader, by setpoints and by their firmware's own mode."""

from __future__ import annotations

import asyncio
from math import cos, hypot, radians, sin

import numpy as np
import pytest

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted, ActionRefused, ActionUnsupported, InvalidArgumentError
from mavstack.geodesy import LocalFrame
from mavstack.sim.vehicle_types import VehicleType
from mavstack.vehicle.following.radio import FollowOptions
from mavstack.vehicle.swarm.fleet import read_states
from mavstack.vehicle.swarm.member import Member
from tests.vehicle.world import ARDUPILOT, PX4, fly

LEADER = (VehicleType.COPTER, ARDUPILOT)
ROVER = (VehicleType.ROVER, ARDUPILOT)


async def in_the_air(world, heights):
    vehicles = list(await world.node.wait_for_vehicles(len(heights)))
    for vehicle, height in zip(vehicles, heights, strict=True):
        await vehicle.arm()
        if height:
            await vehicle.takeoff(height)
    return vehicles


async def leading(vehicle, speed, seconds):
    """Fly the leader east."""
    async with vehicle.guided() as guided:
        guided.velocity(east=speed)
        await asyncio.sleep(seconds)


def gap(leader, follower):
    mine, its = follower.position, leader.position
    north = (its.latitude - mine.latitude) * 111_320
    east = (its.longitude - mine.longitude) * 111_320 * 0.673
    return north, east


@pytest.mark.flight
@pytest.mark.parametrize(
    ("firmware", "level", "largest"),
    [(ARDUPILOT, "radio", 6.0), (PX4, "radio", 3.0), (PX4, "setpoints", 0.7)],
)
@pytest.mark.flight_cases(1)
def test_a_copter_follows_behind_the_leaders_course(firmware, level, largest):
    async def scenario(world, _vehicle):
        leader, follower = await in_the_air(world, [10.0, 20.0])
        following = asyncio.create_task(
            follower.follow(leader, (-12.0, 0.0, 8.0), level=level, duration=45.0)
        )
        flight = asyncio.create_task(leading(leader, 3.0, 50.0))
        await asyncio.sleep(40.0)
        north, east = gap(leader, follower)
        assert hypot(north, east - 12.0) < largest
        assert follower.position.relative_altitude == pytest.approx(18.0, abs=1.0)
        await following
        assert follower.mode.lower() in ("brake", "loiter", "hold")
        await flight

    fly([LEADER, (VehicleType.COPTER, firmware)], scenario)


async def slot_errors(world, leader, follower, offset, seconds):
    """Return the distances of a follower from its slot, forward and right of its leader's true course."""
    found, members, body = [], [Member(leader), Member(follower)], world.simulation.vehicles[0].body
    frame = LocalFrame(leader.position.latitude, leader.position.longitude, 0.0)
    for _ in range(round(10 * seconds)):
        await asyncio.sleep(0.1)
        states = read_states(members, frame, leader.connection.now())
        course = np.array(body.truth[3:5]) / hypot(*body.truth[3:5])
        right = (-course[1], course[0])
        slot = states.positions[0, :2] + offset[0] * course + offset[1] * np.array(right)
        found.append(hypot(*(states.positions[1, :2] - slot)))
    return found


async def turning(vehicle, rate):
    """Drive the leader at 1.5 m/s, turning by some degrees a second."""
    course = 0.0
    async with vehicle.guided() as guided:
        while True:
            guided.velocity(north=1.5 * cos(course), east=1.5 * sin(course))
            await asyncio.sleep(0.1)
            course += radians(rate) / 10.0


@pytest.mark.flight
@pytest.mark.parametrize("rate", [0.0, 5.0, -5.0])
@pytest.mark.flight_cases(1)
def test_a_rover_keeps_its_slot_straight_on_and_in_a_turn(rate):
    offset = (-10.0, 0.0)

    async def scenario(world, _vehicle):
        leader, follower = await in_the_air(world, [0.0, 0.0])
        following = asyncio.create_task(follower.follow(leader, (*offset, 0.0), level="radio"))
        driving = asyncio.create_task(turning(leader, rate))
        await asyncio.sleep(15.0)
        errors = await slot_errors(world, leader, follower, offset, 20.0)
        assert max(errors) < (1.0 if rate else 0.5)
        following.cancel()
        driving.cancel()
        await asyncio.gather(following, driving, return_exceptions=True)

    fly([ROVER, ROVER], scenario)


@pytest.mark.flight
def test_a_follower_that_stays_behind_is_reported():
    async def scenario(world, _vehicle):
        leader, rover = await in_the_air(world, [10.0, 0.0])
        await rover.params.set("WP_SPEED", 1.0)
        flight = asyncio.create_task(leading(leader, 4.0, 60.0))
        with pytest.raises(ActionInterrupted, match="the leader is faster"):
            await rover.follow(leader, level="radio", options=FollowOptions(max_error=30.0))
        assert rover.mode.lower() == "hold"
        flight.cancel()

    fly([LEADER, ROVER], scenario)


@pytest.mark.flight
def test_a_group_follows_by_radio_in_a_formation():
    async def scenario(world, _vehicle):
        leader, *followers = await in_the_air(world, [10.0, 20.0, 30.0])
        flight = asyncio.create_task(leading(leader, 2.0, 60.0))
        await asyncio.sleep(8.0)
        group = world.node.group()
        smallest = await group.follow(leader, "wedge", spacing=14, level="radio", duration=45.0)
        assert smallest > 2.0
        sides = sorted(gap(leader, each)[0] for each in followers)
        assert sides == pytest.approx([-9.9, 9.9], abs=3.0)
        flight.cancel()

    fly([LEADER, (VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4)], scenario)


def test_what_cannot_be_followed_is_refused_and_nothing_is_changed():
    async def scenario(world, vehicle):
        plane, rover = await world.node.wait_for_vehicle(2), await world.node.wait_for_vehicle(3)
        with pytest.raises(InvalidArgumentError, match="cannot follow itself"):
            await vehicle.follow(vehicle)
        with pytest.raises(InvalidArgumentError, match="level must be one of setpoints, radio"):
            await vehicle.follow(rover, level="smoke")
        with pytest.raises(ActionRefused, match="not armed"):
            await vehicle.follow(rover, level="radio")
        await rover.arm()
        with pytest.raises(InvalidArgumentError, match="offset must not be 0"):
            await rover.follow(vehicle, (0.0, 0.0, 0.0), level="radio")
        with pytest.raises(ActionRefused):
            await plane.follow(vehicle, level="radio")
        assert (await rover.params.get("FOLL_ENABLE")).value == 0

    fly([LEADER, (VehicleType.PLANE, ARDUPILOT), ROVER], scenario)


@pytest.mark.parametrize(("before", "after"), [(2.0, 5.0), (10.0, 10.0)])
def test_the_leaders_positions_never_come_less_often_than_before(before, after):
    async def scenario(world, follower):
        leader = await world.node.wait_for_vehicle(2)
        await leader.set_message_rate(common.GlobalPositionInt, before)
        await follower.arm()
        await follower.follow(leader, level="radio", duration=1.0)
        interval = await leader.component.get_message_interval(common.GlobalPositionInt)
        assert interval.rate == pytest.approx(after)

    fly([ROVER, ROVER], scenario)


def test_a_firmware_without_the_mode_is_named():
    async def scenario(world, rover):
        other = await world.node.wait_for_vehicle(2)
        await rover.arm()
        with pytest.raises(ActionUnsupported, match="cannot follow a vehicle by its own mode"):
            await rover.follow(other, level="radio")

    fly([(VehicleType.ROVER, PX4), LEADER], scenario)
