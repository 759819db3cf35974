"""The line that tells how far a swarm is."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest

from mavstack.cli.swarm.progress import heights_text, progress_text


@pytest.mark.parametrize(
    ("progress", "separation", "text"),
    [
        ((0.0, 0.0), math.inf, "move: the plan is made"),
        ((10.0, 40.0), 7.04, "move: 25 %, 30 s left, smallest separation 7.0 m"),
        ((41.0, 40.0), 7.04, "move: 100 %, smallest separation 7.0 m"),
        ((5.0, math.inf), 6.0, "move: smallest separation 6.0 m"),
    ],
)
def test_a_swarm_on_its_way(progress, separation, text):
    swarm = SimpleNamespace(progress=progress, smallest_separation=separation)
    assert progress_text("move", swarm) == text


def test_vehicles_that_climb():
    heights = (0.2, None, 12.34)
    positions = [None if each is None else SimpleNamespace(relative_altitude=each) for each in heights]
    vehicles = [SimpleNamespace(position=each) for each in positions]
    assert heights_text("takeoff", vehicles) == "takeoff: 0.2 to 12.3 m high"
    assert heights_text("takeoff", vehicles[1:2]) == "takeoff: no positions"
