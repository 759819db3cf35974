"""The flights of `mav demo --swarm`."""

from __future__ import annotations

import json
import math

import pytest

from mavstack.cli.demo.swarm_flights import COUNT, circle_show
from mavstack.swarm.separation import Margins
from mavstack.swarm.shows.check import ShowLimits, check_show
from mavstack.swarm.transitions import Limits


def test_the_show_keeps_its_distances_and_limits():
    show = circle_show()
    limits = ShowLimits(Margins().planned_distance, Limits(), math.inf, math.inf)
    assert check_show(show, limits).problems == ()
    assert len(show.vehicles) == COUNT


@pytest.mark.nightly
@pytest.mark.timeout(600)  # a minute and more of processor time
def test_a_formation_a_show_and_a_search_are_flown(mav):
    result = mav("demo", "--swarm", "--for", "330", "--json")
    assert (result.code, result.err) == (0, "")
    parts = json.loads(result.out)["parts"]
    assert not [part for part in parts if part.startswith("landing")]
    assert parts[:5] == [
        "takeoff",
        "formation wedge",
        "moving 30 m north",
        "turning by 90 degrees",
        "a show on a circle",
    ]
    assert "searching in strips, then home" in parts
