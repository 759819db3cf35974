"""Every type and both firmwares fly a whole mission by the API alone, all at once, and over a bad link."""

from __future__ import annotations

import asyncio
from math import hypot

import pytest

from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from tests.sim.running import reduce_telemetry
from tests.sim.whole_flights.plans import triangle, whole_mission
from tests.vehicle.world import ALL, kind_name, world

pytestmark = pytest.mark.nightly

#: How near home it comes to rest, in metres: a plane rolls out along its course.
HOME_WITHIN = {VehicleType.PLANE: 80.0}
NEAR = 4.0
#: The timeout of a mission, in simulated seconds.
MISSION_TIMEOUT = 900.0


class Flown:
    """The outcome of one mission."""

    def __init__(self, plan, system):
        self.plan, self.system, self.reached = plan, system, []
        self.downloaded = self.armed = self.away = None


async def loaded(made, system, plan):
    """Put a mission on a vehicle, and read it back."""
    flight = Flown(plan, system)
    mission = (await made.node.wait_for_vehicle(system)).mission
    await mission.upload(plan.items)
    flight.downloaded = (await mission.download()).items
    return flight


async def flown(made, flight):
    """Fly the mission that is on it."""
    vehicle = await made.node.wait_for_vehicle(flight.system)
    async with vehicle.mission.reached_items() as items:
        await vehicle.mission.fly(timeout=MISSION_TIMEOUT)
        flight.reached = [item.seq for item in items.drain()]
    if not flight.plan.kind.flies:
        await asyncio.sleep(5)
        await vehicle.disarm()
    truth = made.simulation.vehicles[flight.system - 1].body.truth
    flight.armed, flight.away = vehicle.armed, hypot(truth.north, truth.east)
    return flight


async def loaded_and_flown(made, system, plan):
    return await flown(made, await loaded(made, system, plan))


def fly_all(plan_of, **conditions):
    async def whole():
        async with world(*ALL, prepare=reduce_telemetry, **conditions) as made:
            flights = [loaded_and_flown(made, number + 1, plan_of(*kind)) for number, kind in enumerate(ALL)]
            return dict(zip(ALL, await asyncio.gather(*flights), strict=True))

    return run_virtually(whole())


@pytest.fixture(scope="module")
def calm():
    return fly_all(whole_mission)


@pytest.fixture(scope="module")
def bad_link():
    return fly_all(triangle, loss=0.1, latency=0.2, seed=4)


def check(flight):
    first = 1 if flight.plan.firmware is Firmware.ARDUPILOT else 0  # ArduPilot's own home
    assert list(flight.downloaded)[first:] == flight.plan.items[first:]
    assert flight.away < HOME_WITHIN.get(flight.plan.kind, NEAR)
    assert not flight.armed


@pytest.mark.xdist_group("calm")
@pytest.mark.parametrize("kind", ALL, ids=kind_name)
def test_a_whole_mission(calm, kind):
    flight = calm[kind]
    check(flight)
    order = [seq for seq in flight.reached if seq in flight.plan.order]
    assert order[:-1] == flight.plan.order[: len(order) - 1]
    assert len(order) >= len(flight.plan.order) - 2


@pytest.mark.xdist_group("bad link")
@pytest.mark.parametrize("kind", ALL, ids=kind_name)
def test_over_a_lossy_slow_link(bad_link, kind):
    check(bad_link[kind])
