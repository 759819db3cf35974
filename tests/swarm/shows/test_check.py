"""The check of shows."""

from __future__ import annotations

import math

import pytest

from mavstack.swarm.shows.check import ShowLimits, check_show
from mavstack.swarm.shows.reading import parse_show
from mavstack.swarm.shows.show import Curve, Show, ShowVehicle, Trajectory
from mavstack.swarm.transitions import Limits
from tests.swarm.shows.samples import csv_archive, skyc


def test_a_sound_show_has_no_problems():
    report = check_show(parse_show(skyc(4)))
    assert report.problems == ()
    assert report.separation == pytest.approx(15.0 * math.sqrt(2.0), abs=0.05)
    assert report.speed == pytest.approx(15.0 * math.pi / 2 / 40.0, abs=0.05)
    assert report.climb == pytest.approx(1.5, abs=0.01)
    assert check_show(parse_show(csv_archive(3))).problems == ()


def test_each_limit_is_a_problem():
    limits = ShowLimits(30.0, Limits(speed=0.1, climb=0.1, acceleration=0.1), highest=5.0, radius=10.0)
    problems = check_show(parse_show(skyc(4)), limits).problems
    words = ("apart at", "speed over ground", "vertical speed", "acceleration", "height", "distance from")
    assert all(any(word in each for each in problems) for word in words), problems
    assert "Drone" in problems[0]


def crossing(gap):
    """Two vehicles that fly past each other, `gap` metres beside."""
    lines = [((0.0, 0.0, 9.0), (40.0, 0.0, 9.0)), ((40.0, gap, 9.0), (0.0, gap, 9.0))]
    curves = [
        [Curve(0.0, 5.0, [(*a[:2], 0.0), a]), Curve(5.0, 10.0, [a, b]), Curve(15.0, 5.0, [b, (*b[:2], 0.0)])]
        for a, b in lines
    ]
    return Show("crossing", [ShowVehicle(str(index), Trajectory(each)) for index, each in enumerate(curves)])


@pytest.mark.parametrize("gap", [0.0, 1.5, 3.0])
def test_the_smallest_distance_is_found_between_ends(gap):
    assert check_show(crossing(gap)).separation == pytest.approx(
        gap, abs=0.17
    )  # 8 m/s at 25 samples a second


def test_vehicles_on_the_ground_are_near_to_each_other():
    show = parse_show(skyc(40, radius=15.0))
    close = check_show(parse_show(skyc(4, radius=0.5, height=0.9)))
    assert close.separation == math.inf
    assert check_show(show).separation == pytest.approx(2.0 * 15.0 * math.sin(math.pi / 40), abs=0.05)
