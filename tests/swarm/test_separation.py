"""Distances in which height counts half."""

from __future__ import annotations

import math

import numpy as np

from mavstack.swarm.separation import distances, nearest_pair, pairs_below


def test_height_counts_half():
    points = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 10.0], [6.0, 0.0, 0.0]])
    assert distances(points)[0].tolist() == [math.inf, 5.0, 6.0]
    assert nearest_pair(points) == (5.0, 0, 1)
    assert nearest_pair(points[:1])[0] == math.inf
    assert pairs_below(distances(points), 6.5).tolist() == [[0, 1], [0, 2]]
