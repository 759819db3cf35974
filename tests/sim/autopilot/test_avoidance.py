from __future__ import annotations

from math import degrees, hypot, nan

import pytest

from mavstack.dialects import common
from mavstack.services.external import obstacle_message
from mavstack.services.mission import MissionItem
from mavstack.sim import Obstacle
from tests.sim.harness import CMD, SimulationHarness, VehicleHarness

RADIUS, DISTANCE = 3.0, 30.0


def copter(firmware: str = "ardupilot", *, height: float = 100.0, **parameters: float) -> VehicleHarness:
    """Return a copter that hovers south of an obstacle."""
    harness = SimulationHarness()
    harness.simulation.add_obstacle(Obstacle(DISTANCE, 0.0, RADIUS, height))
    one = harness.attach(VehicleHarness(harness, harness.simulation.add("copter", firmware)))
    one.without_telemetry().set(**parameters).run(3)
    return one.place_in_air()


def go(one: VehicleHarness, north: float) -> VehicleHarness:
    """Fly to a point in guided flight for the time that it takes."""
    one.autopilot.guided.go_to((north, 0.0, -20.0))
    return one.run(20)


def fly(one: VehicleHarness, north: float, east: float = 0.0, *, seconds: float = 20) -> VehicleHarness:
    """Fly with a velocity in guided flight."""
    return one.run(seconds, lambda: one.autopilot.guided.fly_velocity(north, east, 0.0))


def push(one: VehicleHarness) -> VehicleHarness:
    """Push the stick forward in the mode that holds a position."""
    one.repeated_message = lambda: common.ManualControl(target=1, x=1000, y=0, z=500, r=0)
    return one.run(20)


def gap(one: VehicleHarness) -> float:
    """Return the metres to the obstacle in the north; negative behind it."""
    return DISTANCE - RADIUS - one.vehicle.body.truth.north


def test_a_guided_velocity_ends_at_the_margin():
    one = fly(copter(AVOID_MARGIN=4), 5.0)
    assert gap(one) == pytest.approx(4.0, abs=0.7)
    assert abs(one.vehicle.body.truth.velocity_north) < 0.3
    fly(one, -3.0, seconds=5)
    assert gap(one) > 10  # the way back is free


def test_loiter_ends_at_the_margin():
    assert gap(push(copter().enter("LOITER"))) == pytest.approx(2.0, abs=0.7)


@pytest.mark.flight
@pytest.mark.parametrize("parameters", [{"AVOID_ENABLE": 1}, {"PRX1_TYPE": 0}])
def test_avoidance_follows_the_parameters(parameters):
    assert gap(fly(copter(**parameters), 5.0)) < 0


@pytest.mark.flight
def test_the_way_past_or_over_an_obstacle_is_free():
    assert gap(fly(copter(height=10.0), 5.0)) < 0
    one = copter()
    one.vehicle.body.place(0.0, 10.0, -20.0, 0.0)
    assert gap(fly(one, 5.0)) < 0


@pytest.mark.flight
def test_a_flight_to_a_point_stops_only_with_the_path_planner():
    assert gap(go(copter(), 60.0)) < 0
    one = go(copter(OA_TYPE=1), 60.0)
    assert gap(one) == pytest.approx(5.0, abs=0.7)
    go(one, 0.0)
    assert gap(one) > 20


@pytest.mark.flight
def test_a_mission_stops_before_an_obstacle():
    one = copter(OA_TYPE=1)
    latitude, longitude, _ = one.vehicle.body.frame.to_global(60.0, 0.0, 0.0)
    frame = common.MavFrame.GLOBAL_RELATIVE_ALT
    one.load(
        MissionItem(CMD.NAV_WAYPOINT, param5=latitude, param6=longitude, param7=20.0, frame=frame),
        MissionItem(CMD.NAV_LOITER_UNLIM, param5=latitude, param6=longitude, param7=20.0, frame=frame),
    )
    one.enter("AUTO").run(25)
    assert gap(one) == pytest.approx(5.0, abs=0.7)


@pytest.mark.flight
def test_px4_prevents_collisions_in_position_mode():
    assert gap(push(copter("px4").enter("Position"))) < 0
    assert gap(push(copter("px4", CP_DIST=3.0).enter("Position"))) == pytest.approx(3.0, abs=0.7)
    assert gap(go(copter("px4", CP_DIST=3.0), 60.0)) < 0  # a pilot's flight only


def rover(kind: str, **parameters: float) -> VehicleHarness:
    """Return a rover or boat south of an obstacle."""
    harness = SimulationHarness()
    harness.simulation.add_obstacle(Obstacle(DISTANCE, 0.0, RADIUS, 100.0))
    one = harness.attach(VehicleHarness(harness, harness.simulation.add(kind, "ardupilot")))
    one.without_telemetry().set(**parameters).run(3)
    one.enter("GUIDED")
    one.autopilot.arm(force=True)
    return one


def drive(one: VehicleHarness, north: float, seconds: float) -> float:
    """Drive to a point; return the nearest distance to the surface of the obstacle."""
    nearest = [1000.0]

    def watch() -> None:
        truth = one.vehicle.body.truth
        nearest[0] = min(nearest[0], hypot(truth.north - DISTANCE, truth.east) - RADIUS)

    one.autopilot.guided.go_to((north, 0.0, 0.0))
    one.run(seconds, watch)
    return nearest[0]


@pytest.mark.parametrize("kind", ["rover", "boat"])
def test_a_rover_and_a_boat_move_around_an_obstacle(kind):
    one = rover(kind, OA_TYPE=1)
    assert drive(one, 60.0, 90) > 2.5
    truth = one.vehicle.body.truth
    assert hypot(truth.north - 60.0, truth.east) < 3.0


def test_a_rover_without_the_planner_drives_into_it():
    assert drive(rover("rover"), 60.0, 30) < 0


def test_obstacles_of_a_companion_computer_count():
    """An obstacle in the north, which the vehicle does not sense itself."""
    harness = SimulationHarness()
    one = harness.add("copter", "ardupilot", PRX1_TYPE=2, AVOID_MARGIN=4)
    one.vehicle.reboot()
    one.without_telemetry().run(10)
    one.place_in_air().enter("GUIDED")

    def report() -> None:
        truth = one.vehicle.body.truth
        sectors = [nan] * 72
        away = 30.0 - truth.north
        turn = round(-degrees(truth.yaw) / 5) % 72
        for sector in (-1, 0, 1):
            sectors[(turn + sector) % 72] = max(away, 0.3)
        one.send(obstacle_message(sectors, 0, min_distance=0.2, max_distance=40.0))
        one.autopilot.guided.fly_velocity(5.0, 0.0, 0.0)

    one.run(20, report)
    assert 30.0 - one.vehicle.body.truth.north == pytest.approx(4.0, abs=1.0)
    one.run(3, lambda: one.autopilot.guided.fly_velocity(5.0, 0.0, 0.0))
    assert one.vehicle.body.truth.north > 30  # the report is too old
