"""Searches around a point."""

from __future__ import annotations

import math

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.geodesy import LocalFrame
from mavstack.swarm.search.division import Searcher
from mavstack.swarm.search.missions import MissionOptions
from mavstack.swarm.search.plans import PATTERNS, pattern_tracks, plan_search

FRAME = LocalFrame(47.0, 8.0, 0.0)


@pytest.mark.parametrize("pattern", PATTERNS)
def test_patterns_stay_in_their_region(pattern):
    tracks = pattern_tracks(pattern, 200.0, 20.0, bearing=30.0)
    places = [place for track in tracks for place in (track.start, track.end)]
    assert 60.0 < max(math.hypot(*place) for place in places) <= 100.0 * math.sqrt(2.0) + 1e-6


def test_the_bearing_is_that_of_parallel_tracks_and_across_creeping_lines():
    for pattern, bearing in (("parallel", 30.0), ("creeping", 120.0)):
        first = pattern_tracks(pattern, 200.0, 20.0, bearing=30.0)[0]
        north, east = (b - a for a, b in zip(first.start, first.end, strict=True))
        assert math.degrees(math.atan2(east, north)) % 180.0 == pytest.approx(bearing)


def test_shares_follow_speed_and_have_their_own_layers():
    tracks = pattern_tracks("parallel", 200.0, 20.0)
    searchers = [Searcher(speed=5.0), Searcher(speed=10.0)]
    slow, fast = plan_search(tracks, searchers, FRAME, MissionOptions(altitude=20.0, layer_spacing=8.0))
    assert fast.length == pytest.approx(2.0 * slow.length, rel=0.01)
    assert (slow.altitude, fast.altitude) == (20.0, 28.0)
    assert len(fast.items) > len(slow.items) > 2


def test_more_vehicles_than_a_search_needs_have_no_mission():
    shares = plan_search([], [Searcher(), Searcher()], FRAME, MissionOptions())
    assert [share.items for share in shares] == [(), ()]


@pytest.mark.parametrize(("pattern", "size"), [("spiral", 200.0), ("square", 0.0), ("sector", math.nan)])
def test_impossible_searches_are_refused(pattern, size):
    with pytest.raises(InvalidArgumentError):
        pattern_tracks(pattern, size, 20.0)
