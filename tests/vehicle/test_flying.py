"""The API flies every type, and sees what it asks for through to its end."""

from __future__ import annotations

import asyncio
from math import atan2, hypot, remainder, tau

import pytest

from mavstack.errors import ActionUnsupported, CommandDenied
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.world import ALL, ARDUPILOT, FLYING, PX4, fly, kind_name

#: The type that circles home until a command lets it land.
CIRCLING = [(VehicleType.PLANE, ARDUPILOT), (VehicleType.VTOL, ARDUPILOT)]
COPTERS = [(VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4)]


def place(world, north, east):
    """Degrees of a place in metres from home."""
    return world.simulated.body.frame.to_global(north, east, 0.0)[:2]


def away(world, north=0.0, east=0.0):
    truth = world.simulated.body.truth
    return hypot(truth.north - north, truth.east - east)


def bearing(world, north):
    """Of the vehicle as seen from a place north of home."""
    truth = world.simulated.body.truth
    return atan2(truth.east, truth.north - north)


def height(world):
    return -world.simulated.body.truth.down


@pytest.mark.flight
@pytest.mark.flight_cases(1)
@pytest.mark.parametrize("kind", FLYING, ids=kind_name)
def test_up_there_and_back(kind):
    wing = kind[0] is not VehicleType.COPTER
    up, there = (60.0, (500.0, 200.0)) if wing else (12.0, (40.0, -25.0))

    async def scenario(world, vehicle):
        await vehicle.arm()
        assert vehicle.armed
        await vehicle.takeoff(up)
        assert height(world) == pytest.approx(up, abs=max(1.5, up / 15))
        await vehicle.goto(*place(world, *there), up + 5)
        assert away(world, *there) < (130 if wing else 3)
        assert height(world) == pytest.approx(up + 5, abs=11 if wing else 2.5)
        await vehicle.rtl()
        if kind in CIRCLING:
            assert away(world) < 130
        elif kind[0] is not VehicleType.PLANE:
            assert not vehicle.armed
            assert away(world) < 3
            assert height(world) < 1

    fly(kind, scenario)


@pytest.mark.flight
@pytest.mark.flight_cases(1)
@pytest.mark.parametrize("kind", [kind for kind in ALL if kind not in FLYING], ids=kind_name)
def test_vehicles_that_do_not_fly_go_and_return(kind):
    async def scenario(world, vehicle):
        await vehicle.arm()
        await vehicle.goto(*place(world, 30.0, 20.0))
        assert away(world, 30.0, 20.0) < 4
        for action in (vehicle.takeoff(10), vehicle.land()):
            with pytest.raises(ActionUnsupported, match="cannot"):
                await action
        if kind == (VehicleType.SUB, ARDUPILOT):
            with pytest.raises(ActionUnsupported):
                await vehicle.rtl()
            await vehicle.goto(*place(world, 0, 0))
        else:
            await vehicle.rtl()
        assert away(world) < 6
        await vehicle.disarm()
        assert not vehicle.armed

    fly(kind, scenario)


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("kind", COPTERS, ids=kind_name)
def test_a_copter_lands_where_it_is(kind):
    async def scenario(world, vehicle):
        await vehicle.arm()
        await vehicle.takeoff(8)
        await vehicle.goto(*place(world, 15.0, 0.0), 8)
        await vehicle.land()
        assert not vehicle.armed
        assert height(world) < 0.5
        assert away(world, 15.0, 0.0) < 3

    fly(kind, scenario)


@pytest.mark.nightly
@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("kind", COPTERS, ids=kind_name)
@pytest.mark.parametrize("radius", [15.0, -15.0])
def test_an_orbit(kind, radius):
    async def scenario(world, vehicle):
        await vehicle.arm()
        await vehicle.takeoff(15)
        world.simulated.autopilot.radio.move(3, 1500)  # in CIRCLE, ArduPilot climbs and sinks by it
        await asyncio.sleep(1)
        await vehicle.orbit(*place(world, 30.0, 0.0), 15, radius=radius, speed=4)
        before = bearing(world, 30.0)
        for _ in range(6):
            await asyncio.sleep(1)
            turned = remainder(bearing(world, 30.0) - before, tau)
            assert turned * radius > 0
            assert away(world, 30.0, 0.0) == pytest.approx(15, abs=4)
            before = bearing(world, 30.0)

    fly(kind, scenario)


@pytest.mark.flight
def test_a_copter_that_would_sink_by_its_throttle_stick_does_not_orbit():
    async def scenario(world, vehicle):
        await vehicle.arm()
        await vehicle.takeoff(15)
        with pytest.raises(ActionUnsupported, match=r"throttle stick is at 1000 us.* center the stick"):
            await vehicle.orbit(*place(world, 30.0, 0.0), 15, radius=15)
        assert vehicle.mode == "GUIDED"
        assert away(world) < 2

    fly((VehicleType.COPTER, ARDUPILOT), scenario)


def test_a_refusal_has_the_vehicles_reason():
    async def scenario(world, vehicle):
        with pytest.raises(CommandDenied) as denied:
            await vehicle.arm()
        assert any("PreArm" in text or "Arm" in text for text in denied.value.status_texts)
        assert denied.value.status_texts[0] in str(denied.value)

    fly((VehicleType.COPTER, ARDUPILOT), scenario, ready=False)
