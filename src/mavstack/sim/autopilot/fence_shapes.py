"""Shapes of a fence: inclusion and exclusion polygons and circles, in metres north and east.

A polygon is closed, may be concave and may cross itself: by the even-odd rule a point is inside if a ray from
it crosses the edges an odd number of times. All shapes lie in the plane around the vehicle's origin, so that
the antimeridian needs no special case.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterator

Place: TypeAlias = "tuple[float, float]"


@dataclass(frozen=True, slots=True)
class Polygon:
    """A polygon of at least three corners."""

    corners: tuple[Place, ...]
    inclusion: bool = True

    @property
    def edges(self) -> Iterator[tuple[Place, Place]]:
        """The edges, each as its two corners."""
        return zip(self.corners, (*self.corners[1:], *self.corners[:1]), strict=True)

    def contains(self, place: Place) -> bool:
        """Return whether a point is inside."""
        north, east = place
        inside = False
        for (north_a, east_a), (north_b, east_b) in self.edges:
            if (east_a > east) != (east_b > east):
                crossing = north_a + (north_b - north_a) * (east - east_a) / (east_b - east_a)
                inside ^= north < crossing
        return inside

    def edge_distance(self, place: Place) -> float:
        """Return the distance to the nearest edge, from either side."""
        return min((segment_distance(place, *edge) for edge in self.edges), default=inf)


@dataclass(frozen=True, slots=True)
class Circle:
    """A circle."""

    centre: Place
    radius: float
    inclusion: bool = True

    def contains(self, place: Place) -> bool:
        """Return whether a point is inside."""
        return self._from_centre(place) < self.radius

    def edge_distance(self, place: Place) -> float:
        """Return the distance to the circle's line, from either side."""
        return abs(self._from_centre(place) - self.radius)

    def _from_centre(self, place: Place) -> float:
        return hypot(place[0] - self.centre[0], place[1] - self.centre[1])


Shape: TypeAlias = Polygon | Circle


@dataclass(frozen=True, slots=True)
class Fence:
    """All shapes of a plan, and the return point."""

    shapes: tuple[Shape, ...] = ()
    return_point: tuple[float, float, float] | None = None

    def permits(self, place: Place, *, union: bool = False) -> bool:
        """Return whether a point is permitted; `union`: inside any of the inclusions is enough."""
        if any(shape.contains(place) for shape in self.shapes if not shape.inclusion):
            return False
        inside = [shape.contains(place) for shape in self.shapes if shape.inclusion]
        return not inside or (any(inside) if union else all(inside))

    def breach_distance(self, place: Place) -> float:
        """Return how far a point is beyond the fence; 0 where it is permitted."""
        wrong = [shape for shape in self.shapes if shape.contains(place) != shape.inclusion]
        return max((shape.edge_distance(place) for shape in wrong), default=0.0)

    def edge_distance(self, place: Place) -> float:
        """Return the distance to the nearest line of all shapes."""
        return min((shape.edge_distance(place) for shape in self.shapes), default=inf)


def segment_distance(place: Place, begin: Place, end: Place) -> float:
    """Return the distance from a point to a line segment."""
    along = end[0] - begin[0], end[1] - begin[1]
    here = place[0] - begin[0], place[1] - begin[1]
    square = along[0] * along[0] + along[1] * along[1]
    share = 0.0 if square == 0 else (here[0] * along[0] + here[1] * along[1]) / square
    share = min(max(share, 0.0), 1.0)
    return hypot(here[0] - along[0] * share, here[1] - along[1] * share)
