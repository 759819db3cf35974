from __future__ import annotations

from itertools import combinations
from math import dist

import pytest

from mavstack.errors import LinkURLError, MavstackError
from mavstack.sim import Fleet, Home, Simulation, VehicleType
from mavstack.sim.fleet import SPACING, link_per_vehicle
from mavstack.sim.motion import LocalFrame


def places(fleet: Fleet) -> list[tuple[float, float]]:
    frame = LocalFrame(fleet.home.latitude, fleet.home.longitude, fleet.home.altitude)
    return [frame.to_local(home.latitude, home.longitude, home.altitude)[:2] for home in fleet.homes()]


@pytest.mark.parametrize("count", [1, 2, 7, 25, 200])
def test_start_positions_are_distinct(count):
    stand = places(Fleet(count=count))
    assert len(stand) == count
    assert stand[0] == pytest.approx((0, 0), abs=0.01)
    for one, other in combinations(stand, 2):
        assert dist(one, other) > 0.99 * SPACING


def test_rows_go_as_the_heading_does():
    north, east = places(Fleet(count=4, home=Home(47, 8, 0, 90)))[1]
    assert (north, east) == pytest.approx(
        (-SPACING, 0), abs=0.05
    )  # to the right of a vehicle that faces east


def test_types_and_firmwares_take_turns():
    simulation = Simulation()
    fleet = Fleet((VehicleType.COPTER, VehicleType.ROVER), count=3, first_system=10)
    vehicles = fleet.add_to(simulation)
    assert [vehicle.vehicle_type for vehicle in vehicles] == ["copter", "rover", "copter"]
    assert [vehicle.address.system for vehicle in vehicles] == [10, 11, 12]


@pytest.mark.parametrize(("first", "count"), [(0, 1), (250, 7), (256, 1)])
def test_ids_that_do_not_fit(first, count):
    with pytest.raises(MavstackError, match="1 to 255"):
        Fleet(count=count, first_system=first).add_to(Simulation())


def test_a_port_for_each():
    assert link_per_vehicle("tcpin://0.0.0.0:5760", 3) == [
        f"tcpin://0.0.0.0:{port}" for port in (5760, 5761, 5762)
    ]
    with pytest.raises(LinkURLError, match="3 ports"):
        link_per_vehicle("udpout://127.0.0.1:65534", 3)
    with pytest.raises(LinkURLError):
        link_per_vehicle("serial:///dev/ttyACM0", 2)
