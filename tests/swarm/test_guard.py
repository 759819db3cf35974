"""The guard finds breaches once, whatever was planned."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.guard import Breach, Guard, GuardLimits, is_inside

APART = np.array([[0.0, 0.0, 10.0], [10.0, 0.0, 10.0]])
NOW = (0.0, 0.0)


def test_vehicles_that_are_too_near_are_found_once():
    guard = Guard(GuardLimits(separation=3.0))
    assert guard.check(APART, NOW) == []
    near = APART * (0.2, 1.0, 1.0)
    (finding,) = guard.check(near, NOW)
    assert (finding.breach, finding.members) == (Breach.SEPARATION, (0, 1))
    assert finding.text == "2.0 m apart, at least 3 m are kept"
    assert guard.check(near, NOW) == []
    assert guard.is_breached
    assert guard.check(APART, NOW) == []
    assert not guard.is_breached
    assert len(guard.check(near, NOW)) == 1
    assert guard.smallest_separation == pytest.approx(2.0)


def test_height_counts_half():
    guard = Guard(GuardLimits(separation=3.0))
    (finding,) = guard.check(np.array([[0.0, 0.0, 10.0], [0.0, 0.0, 15.0]]), NOW)
    assert finding.breach is Breach.SEPARATION
    assert guard.check(np.array([[0.0, 0.0, 10.0], [0.0, 0.0, 17.0]]), NOW) == []


def test_radius_fence_and_heights():
    fence = [(-5.0, -5.0), (20.0, -5.0), (20.0, 5.0), (-5.0, 5.0)]
    guard = Guard(GuardLimits(fence=fence, lowest=2.0, highest=50.0))
    assert guard.check(APART, NOW) == []
    found = guard.check(np.array([[0.0, 9.0, 10.0], [10.0, 0.0, 60.0]]), NOW)
    assert [(each.breach, each.members) for each in found] == [(Breach.FENCE, (0,)), (Breach.HEIGHT, (1,))]
    (finding,) = Guard(GuardLimits(radius=8.0)).check(APART, NOW)
    assert (finding.members, finding.text) == ((1,), "10 m from the origin")


@pytest.mark.parametrize(
    ("limits", "breach"),
    [
        ({"radius": 50.0}, Breach.FENCE),
        ({"fence": ((-9.0, -9.0), (-9.0, 9.0), (9.0, 9.0), (9.0, -9.0))}, Breach.FENCE),
        ({"lowest": 70.0}, Breach.HEIGHT),
        ({"highest": 40.0}, Breach.HEIGHT),
        ({}, None),
    ],
)
def test_each_limit_of_places_counts_alone(limits, breach):
    found = Guard(GuardLimits(**limits)).check(np.array([[100.0, 0.0, 60.0]]), [0.0])
    assert [each.breach for each in found] == ([] if breach is None else [breach])


def test_an_old_or_missing_position_is_a_lost_link():
    guard = Guard(GuardLimits(link_age=3.0))
    found = guard.check(np.vstack((APART, [math.nan] * 3)), (0.5, 4.0, math.inf))
    assert [(each.breach, each.members) for each in found] == [(Breach.LINK, (1,)), (Breach.LINK, (2,))]


def test_only_the_separation_of_other_vehicles_counts():
    guard = Guard(GuardLimits(radius=50.0, separation=3.0))
    assert guard.check(np.vstack((APART, [99.0, 0.0, 10.0])), NOW) == []
    (finding,) = guard.check(np.vstack((APART, [11.0, 0.0, 10.0])), NOW)
    assert (finding.breach, finding.members) == (Breach.SEPARATION, (1, 2))


def test_two_vehicles_that_are_not_members_do_not_count():
    guard = Guard(GuardLimits(separation=3.0))
    others = [[50.0, 0.0, 10.0], [51.0, 0.0, 10.0]]
    assert guard.check(np.vstack((APART, others)), NOW) == []
    assert guard.smallest_separation == pytest.approx(10.0)
    assert guard.check(np.vstack((np.full((2, 3), math.nan), others)), NOW) == []


def test_a_polygon_may_be_concave():
    fence = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (5.0, 2.0), (0.0, 10.0)]
    north, east = np.array([(1.0, 1.0), (5.0, 8.0), (9.0, 5.0), (11.0, 5.0), (math.nan, 5.0)]).T
    assert is_inside(fence, north, east).tolist() == [True, False, True, False, True]


def test_wrong_limits_are_refused():
    with pytest.raises(InvalidArgumentError, match="lowest below highest"):
        GuardLimits(lowest=5.0, highest=5.0)
