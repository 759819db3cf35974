"""Avoidance of aircraft by simulated vehicles of both firmwares."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from tests.sim.harness import SimulationHarness, VehicleHarness, airborne

ACTION, LEVEL = common.MavCollisionAction, common.MavCollisionThreatLevel


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


def plane(**parameters: float) -> VehicleHarness:
    one = airborne("plane", "ardupilot", AVD_ENABLE=1, **parameters)
    one.receiving = True
    one.enter("FBWB").run(1)
    return one


def threaten(one: VehicleHarness, seconds: int, **place: float) -> None:
    """Let an aircraft come from the same direction all the time."""
    for _ in range(seconds):
        one.send(aircraft(one, 900.0, **place))
        one.run(1)


def test_a_plane_warns_at_the_distances_of_planes():
    one = plane()
    one.send(aircraft(one, 1500.0, east=800.0))  # a copter warns within 300 m
    one.run(2)
    assert {each.threat_level for each in collisions(one)} == {LEVEL.LOW}
    one.send(aircraft(one, 1000.0, east=200.0))
    one.run(1)
    assert (collisions(one)[-1].threat_level, collisions(one)[-1].action) == (LEVEL.HIGH, ACTION.REPORT)
    assert one.mode == "FBWB"


@pytest.mark.parametrize(
    ("action", "mode"), [(2, "AVOID_ADSB"), (3, "AVOID_ADSB"), (4, "AVOID_ADSB"), (5, "RTL"), (6, "LOITER")]
)
def test_a_plane_avoids_and_returns_to_its_mode(action, mode):
    one = plane(AVD_F_ACTION=action, AVD_F_RCVRY=1)
    begin = one.vehicle.body.truth
    threaten(one, 1, east=20.0, up=-20.0)
    assert one.mode == mode
    assert collisions(one)[-1].action == action
    assert f"Avoid: Performing action: {action}" in one.texts
    target = one.vehicle.autopilot.target
    threaten(one, 3, east=20.0, up=-20.0)
    truth = one.vehicle.body.truth
    if action in (2, 4):
        assert target[2] == pytest.approx(begin.down - 10, abs=3)  # the aircraft is below: it climbs
    if action == 2:
        assert truth.down < begin.down - 3
    if action == 3:
        assert truth.down == pytest.approx(begin.down, abs=5)
    if action in (3, 4):
        assert truth.velocity_east < -5  # away from the course of the aircraft
    one.send(aircraft(one, -3000.0))
    one.run(5)
    assert one.mode == "FBWB"
    assert "Avoid: Resuming with action: 1" in one.texts


@pytest.mark.parametrize(("altitude", "descends"), [(100.0, True), (200.0, False)])
def test_a_plane_descends_only_above_the_altitude_of_its_return(altitude, descends):
    one = plane(AVD_F_ACTION=2, RTL_ALTITUDE=altitude)
    begin = one.vehicle.body.truth
    threaten(one, 6, up=20.0)
    assert (one.vehicle.body.truth.down > begin.down + 4) is descends
    assert collisions(one)[-1].action == (ACTION.ASCEND_OR_DESCEND if descends else ACTION.NONE)


@pytest.mark.parametrize(("choice", "mode"), [(0, "AVOID_ADSB"), (2, "RTL"), (3, "AVOID_ADSB")])
def test_a_plane_continues_by_its_recovery(choice, mode):
    one = plane(AVD_F_ACTION=3, AVD_F_RCVRY=choice)
    threaten(one, 4)
    one.send(aircraft(one, -3000.0))
    one.run(5)
    assert one.mode == mode
    place = one.vehicle.autopilot.target
    away = max(abs(place[axis] - one.vehicle.autopilot.maneuvers.place[axis]) for axis in (0, 1))
    assert (away > 5000) is (choice == 0)


def test_a_plane_that_a_person_took_over_keeps_its_mode():
    one = plane(AVD_F_ACTION=5, AVD_F_RCVRY=1)
    one.send(aircraft(one, 900.0))
    one.run(2)
    one.enter("CRUISE")
    one.send(aircraft(one, -3000.0))
    one.run(5)
    assert one.mode == "CRUISE"


def test_a_plane_in_manual_does_nothing():
    one = plane(AVD_F_ACTION=5)
    one.enter("MANUAL")
    one.send(aircraft(one, 900.0))
    one.run(2)
    assert one.mode == "MANUAL"
    assert collisions(one)[-1].action == ACTION.NONE


def quadplane(mode: str, **parameters: float) -> VehicleHarness:
    one = airborne("vtol", "ardupilot", AVD_ENABLE=1, **parameters)
    one.receiving = True
    one.enter(mode).run(1)
    return one


def test_a_quadplane_that_lands_by_qland_does_nothing():
    one = quadplane("QLAND", AVD_F_ACTION=5)
    one.send(aircraft(one, 900.0))
    one.run(2)
    assert one.mode == "QLAND"
    assert collisions(one)[-1].action == ACTION.NONE


@pytest.mark.parametrize(("mode", "hold"), [("QHOVER", "QLOITER"), ("FBWB", "LOITER")])
def test_a_quadplane_holds_as_it_flies(mode, hold):
    one = quadplane(mode, AVD_F_ACTION=6)
    if mode == "FBWB":
        one.run(30)  # until the transition is complete
    one.send(aircraft(one, 900.0))
    one.run(2)
    assert one.mode == hold


def test_a_copter_descends_only_above_the_altitude_of_its_return():
    one = copter("ardupilot", AVD_ENABLE=1, AVD_F_ACTION=2, RTL_ALT=5000)
    begin = one.vehicle.body.truth
    one.send(aircraft(one, 900.0, up=20.0))
    one.run(4)
    assert one.mode == "AVOID_ADSB"
    assert one.vehicle.body.truth.down == pytest.approx(begin.down, abs=1)


def test_a_copter_avoids_in_the_middle_of_its_takeoff():
    one = SimulationHarness().add("copter", "ardupilot", AVD_ENABLE=1, AVD_F_ACTION=3, AVD_F_RCVRY=0)
    one.receiving = True
    one.run_until(lambda: one.vehicle.autopilot.has_position, timeout=60)
    one.enter("GUIDED").run(1)
    assert not one.autopilot.arm(force=True)
    one.run(2.5)
    assert one.command(common.MavCmd.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 30) == common.MavResult.ACCEPTED
    one.run_until(lambda: one.autopilot.altitude > 2)
    begin = one.vehicle.body.truth
    threaten(one, 4, east=20.0)
    assert one.mode == "AVOID_ADSB"
    assert one.vehicle.body.truth.east < begin.east - 3
    assert one.autopilot.armed


@pytest.mark.parametrize("seconds", [0.5, 3.0])
def test_a_copter_that_is_armed_on_the_ground_disarms(seconds):
    one = SimulationHarness().add("copter", "ardupilot", AVD_ENABLE=1, AVD_F_ACTION=3)
    one.receiving = True
    one.run_until(lambda: one.vehicle.autopilot.has_position, timeout=60)
    one.enter("GUIDED").run(1)
    assert not one.autopilot.arm(force=True)
    one.run(seconds)
    one.send(aircraft(one, 900.0, east=20.0))
    one.run(1)
    assert not one.autopilot.armed
    assert collisions(one)[-1].action == ACTION.NONE


def test_a_copter_in_land_does_nothing():
    one = copter("ardupilot", AVD_ENABLE=1, AVD_F_ACTION=3)
    one.enter("LAND").run(1)
    one.send(aircraft(one, 900.0, east=20.0))
    one.run(2)
    assert (one.mode, collisions(one)[-1].action) == ("LAND", ACTION.NONE)


@pytest.mark.parametrize(("above_home", "mode"), [(30, "GUIDED"), (10, "AVOID_ADSB")])
def test_the_lowest_altitude_of_the_avoidance_is_above_the_sea(above_home, mode):
    one = copter("ardupilot", AVD_ENABLE=1, AVD_F_ACTION=3)
    ground = one.vehicle.body.frame.to_global(0.0, 0.0, 0.0)[2]
    one.vehicle.parameters.set("AVD_F_ALT_MIN", round(ground) + above_home)  # it flies 20 m above home
    one.enter("GUIDED").run(1)
    one.send(aircraft(one, 900.0, east=20.0))
    one.run(2)
    assert one.mode == mode
