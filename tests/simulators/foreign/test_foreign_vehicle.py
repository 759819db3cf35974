"""Simulated vehicles as PX4 and ArduPilot in a simulator: here our own worlds."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.simulators import ArduPilotSimulator, Px4Simulator
from mavstack.simulators.foreign import ForeignVehicle
from tests.simulators.foreign.worlds import flown, running


def px4_world(physics="copter"):
    return Px4Simulator(physics, listen="tcpin://127.0.0.1:0", speed=0.0)


def ardupilot_world(physics):
    return ArduPilotSimulator(physics, listen="udpin://127.0.0.1:0")


async def test_a_vehicle_is_found_in_each_world():
    for firmware, world in (("px4", px4_world()), ("ardupilot", ardupilot_world("copter"))):
        async with running(world), flown(firmware, "copter", world.port) as (made, vehicle):
            assert vehicle.address.system == 1
            assert made.time > 0.0
            assert "the simulator waits for" in made.status


@pytest.mark.flight
@pytest.mark.parametrize("has_truth", [True, False])
@pytest.mark.flight_cases(1)
async def test_px4_takes_off_moves_and_lands(has_truth, monkeypatch):
    world = px4_world()
    if not has_truth:  # the vehicle has to estimate its state from the sensors
        monkeypatch.setattr("mavstack.simulators.px4.TRUTH_STEPS", 10**9)
    async with running(world), flown("px4", "copter", world.port) as (_, vehicle):
        await vehicle.arm()
        await vehicle.takeoff(8)
        assert world.state.position[2] == pytest.approx(-8.0, abs=1.5)
        await vehicle.goto(vehicle.position.latitude + 0.0002, vehicle.position.longitude)
        assert world.state.position[0] == pytest.approx(22.0, abs=2.5)
        await vehicle.land()
        assert world.state.position[2] == pytest.approx(0.0, abs=0.05)
        assert world.interface.extra_answers == 0


@pytest.mark.flight
async def test_ardupilot_drives_a_rover():
    world = ardupilot_world("rover")
    async with running(world), flown("ardupilot", "rover", world.port) as (_, vehicle):
        await vehicle.arm()
        await vehicle.goto(vehicle.position.latitude + 0.0003, vehicle.position.longitude + 0.0002)
        north, east, _ = world.state.position
        assert (north, east) == pytest.approx((33.4, 15.1), abs=3.0)


@pytest.mark.flight
async def test_ardupilot_flies_a_plane():
    world = ardupilot_world("plane")
    async with running(world), flown("ardupilot", "plane", world.port) as (_, vehicle):
        await vehicle.arm()
        await vehicle.takeoff(40)
        assert world.state.position[2] < -30.0


async def test_a_world_that_ends_ends_the_flight():
    async with running(px4_world()) as world:
        made = ForeignVehicle("px4", to=f"tcpout://127.0.0.1:{world.port}")
        async with made:
            flying = asyncio.ensure_future(made.run())
            while made.time < 0.2:  # noqa: ASYNC110
                await asyncio.sleep(0)
            await world._close()
            await asyncio.wait_for(flying, 10)


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({"vehicle_type": "sub"}, "a sub cannot fly in another simulator"),
        ({"to": "udpout://127.0.0.1:1"}, r"must be tcpout://HOST:PORT"),
    ],
)
def test_wrong_arguments_are_refused(options, problem):
    with pytest.raises(InvalidArgumentError, match=problem):
        ForeignVehicle(**{"firmware": "px4", "to": "tcpout://127.0.0.1:1"} | options)
