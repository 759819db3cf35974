from __future__ import annotations

from math import inf, pi, sqrt

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.sim import DEFAULT_HOME, VehicleType
from mavstack.sim.motion import World
from mavstack.sim.motion.obstacles import Cylinder, Obstacle, Surroundings, turned

TREE = Cylinder(30.0, 0.0, 2.0, -15.0)
FORWARD, DOWN = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


@pytest.mark.parametrize(
    ("here", "ray", "distance"),
    [
        ((0, 0, -10), FORWARD, 28.0),
        ((0, 1, -10), FORWARD, 30 - sqrt(3)),  # off the axis
        ((0, 3, -10), FORWARD, inf),  # past it
        ((0, 0, -20), FORWARD, inf),  # above it
        ((60, 0, -10), FORWARD, inf),  # behind
        ((30, 1, -20), DOWN, 5.0),  # its roof
        ((30, 0, -5), FORWARD, 0.0),  # inside
    ],
)
def test_distance_along_a_ray(here, ray, distance):
    assert TREE.distance_along(here, ray) == pytest.approx(distance)


def test_the_ground_hides_and_is_hidden():
    around = Surroundings()
    assert around.distance_along((0, 0, -10), DOWN) == 10
    assert around.distance_along((0, 0, -10), FORWARD) == inf
    around.cylinders.append(TREE)
    assert around.distance_along((30, 0, -20), DOWN) == 5
    assert around.distance_along((0, 0, -10), (0.8, 0.0, 0.6)) == pytest.approx(10 / 0.6)


def test_a_thin_pole_is_in_exactly_its_sectors():
    around = Surroundings()
    around.cylinders.append(Cylinder(0.0, 30.0, 0.05, -inf))  # east, thinner than the distance of two rays
    near = [number for number, each in enumerate(around.sectors((0, 0, -5), 0.0, 72)) if each < inf]
    assert near == [18]
    near = [number for number, each in enumerate(around.sectors((0, 0, -5), pi / 2, 72)) if each < inf]
    assert near == [0]


def test_clearance_ends_at_the_margin():
    assert TREE.clearance_along((0, 0, -10), (1, 0), 3.0) == pytest.approx(25)
    assert TREE.clearance_along((0, 5.1, -10), (1, 0), 3.0) == inf  # passes with the margin
    assert TREE.clearance_along((0, 0, -10), (-1, 0), 3.0) == inf
    assert TREE.clearance_along((26, 0, -10), (1, 0), 3.0) == 0  # nearer than the margin already


def test_a_vector_turns_with_the_body():
    assert turned(FORWARD, 0, 0, pi / 2) == pytest.approx((0, 1, 0))
    assert turned(FORWARD, 0, pi / 2, 0) == pytest.approx((0, 0, -1))  # nose up
    assert turned(DOWN, pi / 2, 0, 0) == pytest.approx((0, -1, 0))  # right wing down: looks to the left


@pytest.mark.parametrize(
    "text", ["", "1,2", "1,2,x", "1,2,0", "1,2,-3", "1,2,3,0", "nan,0,1", "1,2,3,4,5", "0,0,nan"]
)
def test_wrong_obstacles(text):
    with pytest.raises(InvalidArgumentError):
        Obstacle.parse(text)


def test_every_body_has_the_obstacles_in_its_own_frame():
    world = World()
    first = world.add(VehicleType.COPTER, DEFAULT_HOME)
    world.add_obstacle(Obstacle.parse("30,0,2,15"), DEFAULT_HOME)
    second = world.add(VehicleType.COPTER, DEFAULT_HOME._replace(altitude=DEFAULT_HOME.altitude + 5))
    assert first.surroundings.cylinders[0] == pytest.approx((30, 0, 2, -15), abs=0.01)
    assert second.surroundings.cylinders[0] == pytest.approx((30, 0, 2, -10), abs=0.01)
