"""Real firmware in its slots: PX4 in offboard mode, ArduRover in Follow mode; the environment names them."""

from __future__ import annotations

import asyncio
import math
import os
from contextlib import suppress

import numpy as np
import pytest

from mavstack.dialects import common
from mavstack.geodesy import LocalFrame
from mavstack.sim.background import BackgroundSimulator
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType
from mavstack.swarm.courses import Turn
from mavstack.vehicle import connect
from mavstack.vehicle.swarm.fleet import read_states
from mavstack.vehicle.swarm.member import Member
from tests.simulators.firmwares import free_port
from tests.waiting import wait_until

pytestmark = [pytest.mark.interop, pytest.mark.timeout(300)]
FRAME = LocalFrame(DEFAULT_HOME.latitude, DEFAULT_HOME.longitude, DEFAULT_HOME.altitude)
#: Metres between a member and its slot, straight on and in turns.
STRAIGHT, TURNING = 0.5, 2.0


def program(variable):
    path = os.environ.get(variable)
    if not path:
        pytest.skip(f"{variable} names no program")
    return path


async def slot_errors(swarm, flight):
    """Return the distances between the member and its place while a call flies."""
    controller, found = swarm._running, []
    task = asyncio.create_task(flight)
    while not task.done():
        await asyncio.sleep(0.1)
        planned, _ = controller._course.state(controller._elapsed)
        found.append(float(np.linalg.norm(swarm.places - planned)))
    await task
    return found


def test_a_real_px4_keeps_its_slot_in_offboard_mode(firmware):
    flight = firmware("px4", program("MAVSTACK_PX4"), speed=1.0)

    async def scenario():
        async with connect(flight.url) as connection:
            vehicle = await connection.wait_for_vehicle(timeout=60)
            await vehicle.wait_until_ready()
            await vehicle.arm()
            await vehicle.takeoff(12)
            async with connection.swarm() as swarm:
                straight = await slot_errors(swarm, swarm.move(north=50.0))
                controller, places = swarm._running, swarm.places
                centre = (float(places[0, 0]), float(places[0, 1]) + 15.0)
                turn = Turn(places, centre, 180.0, swarm.options.limits)
                turning = await slot_errors(swarm, controller.fly(turn, controller.active))
            await vehicle.land()
            return max(straight), max(turning)

    straight, turning = asyncio.run(scenario())
    print(f"PX4: at most {straight:.2f} m straight on, {turning:.2f} m in a turn")
    assert straight <= STRAIGHT
    assert turning <= TURNING


async def lead(vehicle, parts):
    """Drive the leader at 1.5 m/s, turning by some degrees a second.

    It does not stop between the parts, since a follower has to catch up after a stop.
    """
    course = 0.0
    async with vehicle.guided() as guided:
        for seconds, rate in parts:
            for _ in range(round(10 * seconds)):
                course += math.radians(rate) / 10.0
                guided.velocity(north=1.5 * math.cos(course), east=1.5 * math.sin(course))
                await asyncio.sleep(0.1)


async def gaps(leader, follower, body, seconds):
    """Return the distances of a follower from the place 10 m behind its leader's true course."""
    vehicles, found = [Member(leader), Member(follower)], []
    for _ in range(round(10 * seconds)):
        await asyncio.sleep(0.1)
        states = read_states(vehicles, FRAME, leader.connection.now())
        motion = np.array(body.truth[3:5])
        slot = states.positions[0, :2] - 10.0 * motion / np.linalg.norm(motion)
        found.append(float(np.linalg.norm(states.positions[1, :2] - slot)))
    return found


def test_a_real_ardurover_keeps_its_slot_in_follow_mode(firmware):
    flight = firmware(
        "ardupilot",
        program("MAVSTACK_ARDUROVER"),
        vehicle="rover",
        speed=1.0,
        instance=5,
        out=(f"tcpin://127.0.0.1:{free_port()}",),
    )
    latitude, longitude, _ = FRAME.to_global(12.0, 0.0, 0.0)
    simulator = BackgroundSimulator(count=0)
    body = simulator.simulation.add(
        VehicleType.ROVER, Firmware.ARDUPILOT, home=Home(latitude, longitude, DEFAULT_HOME.altitude), system=2
    ).body

    async def scenario():
        async with connect(flight.url, simulator.url) as connection:
            follower, leader = [await connection.wait_for_vehicle(each, timeout=90) for each in (1, 2)]
            for vehicle in (follower, leader):
                await vehicle.set_message_rate(common.GlobalPositionInt, 10.0)
                await vehicle.wait_until_ready()
                await vehicle.arm()
            following = asyncio.create_task(
                follower.follow(leader, (-10.0, 0.0, 0.0), level="radio", duration=None)
            )
            await wait_until(lambda: follower.mode == "FOLLOW", interval=0.05, now=connection.now)
            leading = asyncio.create_task(lead(leader, ((24.0, 0.0), (18.0, 5.0))))
            await asyncio.sleep(15.0)
            straight = await gaps(leader, follower, body, 8.0)
            await asyncio.sleep(2.0)
            turning = await gaps(leader, follower, body, 15.0)
            await leading
            following.cancel()
            with suppress(asyncio.CancelledError):
                await following
            return straight, turning

    with simulator:
        straight, turning = asyncio.run(scenario())
    print(f"rover: mean {np.mean(straight):.2f} m, at most {max(straight):.2f} m straight on")
    print(f"rover: mean {np.mean(turning):.2f} m, at most {max(turning):.2f} m in a turn")
    assert max(straight) <= STRAIGHT
    assert max(turning) <= TURNING
