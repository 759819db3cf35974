"""The circle around a place, by reported positions."""

from __future__ import annotations

from math import cos, radians, sin
from types import SimpleNamespace

import pytest

from mavstack.geodesy import offset_location
from mavstack.vehicle.actions.circling import CircleTracker
from mavstack.vehicle.telemetry.values import Position

HERE = (47.0, 8.0)


def tracked(points, place=HERE):
    """Return the tracker after positions at metres north and east of a place, and metres of altitude."""
    vehicle = SimpleNamespace(position=None)
    tracker = CircleTracker(vehicle)
    for north, east, *altitude in points:
        vehicle.position = Position(*offset_location(*place, north, east), 500.0, *altitude)  # type: ignore[call-arg]
        tracker.update(*place)
    return tracker


def arc(radius, begin, end, step=2.0, altitude=50.0, climb=0.0):
    """Yield points on a circle, from one bearing in degrees to another."""
    count = int(abs(end - begin) / step)
    for number in range(count + 1):
        angle = radians(begin + (end - begin) * number / count)
        yield radius * cos(angle), radius * sin(angle), altitude + climb * number


@pytest.mark.parametrize(("begin", "end"), [(0, 100), (100, 0), (300, 420), (-170, -290)])
def test_a_circle_is_established_after_a_quarter(begin, end):
    tracker = tracked(arc(80.0, begin, end))
    assert tracker.established
    assert tracker.swept == pytest.approx(end - begin, abs=2)
    assert tracker.radius == pytest.approx(80.0, abs=0.5)
    assert tracker.climbed == 0.0
    assert not tracked(arc(80.0, 0, 85)).established


def test_a_circle_around_the_date_line():
    tracker = tracked(arc(80.0, 0, 350), place=(-17.0, 180.0))
    assert tracker.swept == pytest.approx(350, abs=3)
    assert tracker.radius == pytest.approx(80.0, abs=0.5)


@pytest.mark.parametrize("aside", [1.5, 10.0, 60.0, 300.0])
def test_a_straight_pass_is_no_circle(aside):
    points = [(north, aside) for north in range(-1000, 1001, 4)]
    assert not any(tracked(points[:end]).established for end in range(1, len(points), 7))


def test_a_wing_that_comes_from_afar_has_swept_only_its_circle():
    straight = [(north, 60.0) for north in range(-900, 0, 5)]
    tracker = tracked([*straight, *arc(60.0, 90.0, -30.0)])
    assert tracker.established
    assert tracker.swept == pytest.approx(-120 - 40, abs=6)  # the last metres of a tangent are as far away
    assert tracker.radius == pytest.approx(60.0, abs=2)


def test_a_reversal_begins_a_new_circle():
    tracker = tracked([*arc(20.0, 0, 200), *arc(20.0, 198, 150)])
    assert tracker.swept == pytest.approx(-50, abs=5)


def test_noise_is_no_reversal():
    points = [
        (20.0 * cos(radians(a + d)), 20.0 * sin(radians(a + d))) for a in range(0, 180, 3) for d in (0, -4)
    ]
    assert tracked(points).swept == pytest.approx(177, abs=8)


def test_a_climb_is_measured():
    tracker = tracked(arc(80.0, 0, 200, climb=1.0))
    assert tracker.climbed == pytest.approx(45, abs=2)  # of the last quarter


def test_another_place_begins_a_new_circle():
    vehicle = SimpleNamespace(position=Position(47.001, 8.0, 500.0, 50.0))
    tracker = CircleTracker(vehicle)
    for north, east, *_ in arc(80.0, 0, 120):
        vehicle.position = Position(*offset_location(*HERE, north, east), 500.0, 50.0)
        tracker.update(*HERE)
    assert tracker.established
    tracker.update(47.01, 8.0)
    assert tracker.swept == 0.0
    assert not tracker.established


def test_nothing_is_known_without_a_position():
    tracker = tracked([])
    tracker.update(*HERE)
    assert (tracker.swept, tracker.radius, tracker.climbed, tracker.established) == (0.0, None, None, False)
