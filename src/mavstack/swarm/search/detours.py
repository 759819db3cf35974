"""Ways between tracks that stay inside an area and go around its obstacles.

The shortest way among corners turns at corners only, so it is found on the graph of corners that see each
other.
"""

from __future__ import annotations

import heapq
import math
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.swarm.arrays import Points
    from mavstack.swarm.search.areas import Area, Corner

#: Share of a line at each end in which crossings are ignored, because lines begin and end on borders.
_ENDS: Final = 1e-6


def detour(area: Area, start: Corner, end: Corner) -> list[Corner]:
    """Return the corners of the shortest way from one place to another within an area.

    Args:
        area: The area; places outside of it are reached in a straight line.
        start: Metres north and east.
        end: Metres north and east.

    Returns:
        The corners between start and end; empty if the straight line stays within the area.
    """
    if _is_free(area, start, end):
        return []
    corners = [(float(north), float(east)) for ring in area.rings for north, east in ring]
    nodes = [start, *corners, end]
    distances: dict[int, float] = {0: 0.0}
    before: dict[int, int] = {}
    queue, last = [(0.0, 0)], len(nodes) - 1
    while queue:
        so_far, node = heapq.heappop(queue)
        if node == last:
            return [nodes[index] for index in _trace(before, last)]
        for other in range(len(nodes)):
            length = so_far + math.dist(nodes[node], nodes[other])
            if length < distances.get(other, math.inf) and _is_free(area, nodes[node], nodes[other]):
                distances[other], before[other] = length, node
                heapq.heappush(queue, (length, other))
    return []


def _trace(before: dict[int, int], node: int) -> list[int]:
    way: list[int] = []
    while before[node] != 0:
        node = before[node]
        way.append(node)
    return way[::-1]


def _is_free(area: Area, start: Corner, end: Corner) -> bool:
    """Return True if a line crosses no border and its middle is inside."""
    if start == end:
        return True
    return not any(_crosses(ring, start, end) for ring in area.rings) and _is_inside(
        area.rings, _middles(start, end)
    )


def _crosses(ring: Points, start: Corner, end: Corner) -> bool:
    """Return True if a line crosses an edge of a ring, apart from the ends of both."""
    after = np.roll(ring, -1, axis=0)
    line = np.subtract(end, start)
    edges, offsets = after - ring, ring - start
    denominator = line[0] * edges[:, 1] - line[1] * edges[:, 0]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # parallel lines divide by zero
        on_line = (offsets[:, 0] * edges[:, 1] - offsets[:, 1] * edges[:, 0]) / denominator
        on_edge = (offsets[:, 0] * line[1] - offsets[:, 1] * line[0]) / denominator
        hit = (on_line > _ENDS) & (on_line < 1.0 - _ENDS) & (on_edge > _ENDS) & (on_edge < 1.0 - _ENDS)
    return bool(hit.any())


def _middles(start: Corner, end: Corner) -> Points:
    shares = np.array((0.25, 0.5, 0.75))[:, None]
    middles: Points = np.asarray(start) * (1.0 - shares) + np.asarray(end) * shares
    return middles


def _is_inside(rings: Sequence[Points], places: Points) -> bool:
    """Return True if all places are inside the outline and outside the obstacles, or on a border."""
    return all(_contains(rings, north, east) for north, east in places.tolist())


def _contains(rings: Sequence[Points], north: float, east: float) -> bool:
    crossings = 0
    for ring in rings:
        after = np.roll(ring, -1, axis=0)
        if _on_border(ring, after, north, east):
            return True
        crosses = (ring[:, 1] > east) != (after[:, 1] > east)
        begin, end = ring[crosses], after[crosses]
        share = (east - begin[:, 1]) / (end[:, 1] - begin[:, 1])
        crossings += int((begin[:, 0] + share * (end[:, 0] - begin[:, 0]) > north).sum())
    return crossings % 2 == 1


def _on_border(ring: Points, after: Points, north: float, east: float) -> bool:
    edges, offsets = after - ring, np.array((north, east)) - ring
    lengths = np.maximum((edges * edges).sum(axis=1), 1e-12)
    shares = np.clip((offsets * edges).sum(axis=1) / lengths, 0.0, 1.0)
    return bool((np.linalg.norm(offsets - shares[:, None] * edges, axis=1) < 1e-6).any())
