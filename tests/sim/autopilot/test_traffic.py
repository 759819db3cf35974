"""Avoidance of aircraft by simulated vehicles of both firmwares."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from tests.sim.harness import SimulationHarness, VehicleHarness, airborne

LEVEL = common.MavCollisionThreatLevel


def aircraft(one: VehicleHarness, north: float, *, east: float = 0.0, up: float = 0.0, speed: float = 50.0):
    """Return an aircraft at metres from the vehicle that flies south."""
    here = one.vehicle.body.truth
    latitude, longitude, altitude = one.vehicle.body.frame.to_global(
        here.north + north, here.east + east, here.down - up
    )
    flags = common.AdsbFlags
    return common.AdsbVehicle(
        ICAO_address=0xABCDEF, lat=round(latitude * 1e7), lon=round(longitude * 1e7),
        altitude=round(altitude * 1e3), heading=18_000, hor_velocity=round(speed * 100), callsign="LX1",
        flags=flags.VALID_COORDS | flags.VALID_ALTITUDE | flags.VALID_HEADING | flags.VALID_VELOCITY,
    )  # fmt: skip


def copter(firmware: str, **parameters: float) -> VehicleHarness:
    one = airborne("copter", firmware, **parameters)
    one.receiving = True
    return one


def collisions(one: VehicleHarness) -> list[common.Collision]:
    return [message for message in one.received if isinstance(message, common.Collision)]


def test_ardupilot_reports_threats():
    one = copter("ardupilot", AVD_ENABLE=1)
    one.send(aircraft(one, 1000.0, east=200.0))
    one.run(3)
    assert {(each.threat_level, each.action) for each in collisions(one)} == {(LEVEL.LOW, 1)}
    found = collisions(one)[-1]
    assert (found.id, found.src) == (0xABCDEF, 0)
    assert found.horizontal_minimum_delta == pytest.approx(200, abs=5)
    assert found.time_to_minimum_delta < 20
    assert len(collisions(one)) == 3
    one.send(aircraft(one, 800.0))
    one.run(2)
    assert collisions(one)[-1].threat_level == LEVEL.HIGH
    assert one.mode not in ("AVOID_ADSB", "RTL")  # it reports only


@pytest.mark.parametrize("where", [{"east": 800.0}, {"up": 500.0}, {"north": -1000.0}])
def test_ardupilot_ignores_aircraft_that_pass(where):
    one = copter("ardupilot", AVD_ENABLE=1)
    one.send(aircraft(one, **({"north": 1000.0} | where)))
    one.run(3)
    assert collisions(one) == []


def test_ardupilot_is_silent_without_avoidance():
    one = copter("ardupilot")
    one.send(aircraft(one, 500.0))
    one.run(3)
    assert collisions(one) == []


@pytest.mark.parametrize(
    ("action", "mode"), [(2, "AVOID_ADSB"), (3, "AVOID_ADSB"), (5, "RTL"), (6, "LOITER")]
)
def test_ardupilot_avoids_and_returns_to_its_mode(action, mode):
    one = copter("ardupilot", AVD_ENABLE=1, AVD_F_ACTION=action, AVD_F_RCVRY=1)
    one.enter("GUIDED").run(1)
    begin = one.vehicle.body.truth
    one.send(aircraft(one, 900.0, east=20.0))
    one.run(4)
    assert one.mode == mode
    truth = one.vehicle.body.truth
    if action == 2:
        assert abs(truth.down - begin.down) > 3
    if action == 3:
        assert truth.east < begin.east - 3  # away from the course of the aircraft
    one.send(aircraft(one, -900.0))
    one.run(5)
    assert one.mode == "GUIDED"


@pytest.mark.parametrize(("choice", "mode"), [(1, "Hold"), (2, "Return"), (3, "Land"), (4, "Hold")])
def test_px4_acts_on_conflicts(choice, mode):
    one = copter("px4", NAV_TRAFF_AVOID=choice)
    one.send(aircraft(one, 1500.0, east=100.0))
    one.run(2)
    assert one.mode == mode
    text = one.texts.first("Traffic alert - ICAO Address 11259375! Separation Distance 100, Heading")
    assert text.endswith({2: "returning home", 3: "landing", 4: "holding position"}.get(choice, "180"))
    one.send(aircraft(one, -2000.0))
    one.run(1)
    assert "Traffic Conflict Resolved 11259375!" in one.texts


@pytest.mark.parametrize("where", [{"east": 600.0}, {"up": 600.0}, {"speed": 0.0}, {"north": 9000.0}])
def test_px4_ignores_aircraft_that_pass(where):
    one = copter("px4", NAV_TRAFF_AVOID=2)
    one.send(aircraft(one, **({"north": 1500.0} | where)))
    one.run(2)
    assert not one.texts.first("Traffic alert")


def test_other_vehicles_are_traffic():
    one = copter("px4")
    here = one.vehicle.body.truth
    latitude, longitude, altitude = one.vehicle.body.frame.to_global(here.north + 300, here.east, here.down)
    position = common.UtmGlobalPosition(
        lat=round(latitude * 1e7), lon=round(longitude * 1e7), alt=round(altitude * 1e3), vx=-1000
    )
    one.send(position, source=one.source._replace(system=7))
    one.run(1)
    assert one.texts.first("Traffic alert - ICAO Address 7!")


def test_a_vehicle_on_the_ground_does_nothing():
    one = SimulationHarness().add("copter", "px4", NAV_TRAFF_AVOID=2)
    one.run(3)
    one.send(aircraft(one, 500.0))
    one.run(2)
    assert not one.texts.first("Traffic alert")
