"""The radius of circles and orbits: kept, or refused before anything is sent where a firmware ignores it."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import ActionUnsupported
from mavstack.services.version import FirmwareVersion
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.actions.test_arrival import Measured, commands, place, sent, start
from tests.vehicle.world import ARDUPILOT, PX4, fly, kind_name

COPTER, PLANE = VehicleType.COPTER, VehicleType.PLANE


@pytest.mark.flight
def test_a_plane_of_an_older_version_refuses_a_radius_that_it_would_ignore():
    async def scenario(world, vehicle):
        await start(vehicle, (PLANE, ARDUPILOT))
        received, mode = sent(world), vehicle.mode
        there = place(world, 300.0, 0.0)
        for call in (
            vehicle.orbit(*there, 60, radius=120),
            vehicle.orbit(*there, 60, radius=-120, wait=False),
            vehicle.goto(*there, 60, radius=120),
        ):
            with pytest.raises(
                ActionUnsupported, match=r"ArduPlane 4\.1 ignores .* at WP_LOITER_RAD, 60 m; set"
            ):
                await call
        assert commands(received) == []
        assert vehicle.mode == mode
        await vehicle.params.set("WP_LOITER_RAD", 120)
        await vehicle.orbit(*there, 60, radius=-120)
        measured = Measured(world, 300.0)
        assert measured.away == pytest.approx(120, abs=30)
        assert measured.turning < 0

    fly((PLANE, ARDUPILOT), scenario, version=FirmwareVersion(4, 1))


@pytest.mark.flight
def test_a_plane_of_px4_refuses_a_radius_of_goto():
    async def scenario(world, vehicle):
        await start(vehicle, (PLANE, PX4))
        received = sent(world)
        with pytest.raises(ActionUnsupported, match=r"PX4 ignores .* at NAV_LOITER_RAD, 80 m; set"):
            await vehicle.goto(*place(world, 300.0, 0.0), 60, radius=150)
        assert commands(received) == []

    fly((PLANE, PX4), scenario)


@pytest.mark.flight
@pytest.mark.parametrize(
    "kind", [(COPTER, PX4), (COPTER, ARDUPILOT), (PLANE, PX4), (PLANE, ARDUPILOT)], ids=kind_name
)
@pytest.mark.flight_cases(1)
def test_an_orbit_the_other_way_round_ends_when_the_vehicle_flies_it(kind):
    radius = 20.0 if kind[0] is COPTER else 90.0

    async def scenario(world, vehicle):
        await start(vehicle, kind)
        world.simulated.autopilot.radio.move(3, 1500)
        await asyncio.sleep(1)
        there = place(world, 60.0, 0.0)
        for each in (radius, -radius):
            await vehicle.orbit(*there, -world.simulated.body.truth.down, radius=each)
            measured = Measured(world, 60.0)
            assert measured.turning * each > 0
            assert measured.away == pytest.approx(radius, abs=max(2.0, radius / 4))

    fly(kind, scenario)
