"""Obstacles: upright cylinders that stand on the ground, and the distances to them.

Rangefinders measure along rays, a proximity sensor in horizontal sectors. Bodies do not collide: one that is
not stopped flies through an obstacle.
"""

from __future__ import annotations

from math import asin, atan2, cos, hypot, inf, isfinite, remainder, sin, sqrt, tau
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Self

Point: TypeAlias = tuple[float, float, float]

#: A ray whose horizontal (or vertical) part is not larger than this is parallel to walls (or to the ground),
#: and does not meet them.
_PARALLEL: Final = 1e-9
_FAR: Final = 1e5


class Obstacle(NamedTuple):
    """A cylinder: metres north and east of home to its axis, its radius, its height above the ground."""

    north: float
    east: float
    radius: float
    height: float = inf

    @classmethod
    def parse(cls, text: str) -> Self:
        """Parse `NORTH,EAST,RADIUS[,HEIGHT]` in metres; raises InvalidArgumentError."""
        try:
            obstacle = cls(*(float(part) for part in text.split(",")))
        except (TypeError, ValueError):
            raise InvalidArgumentError(
                f"obstacle {text!r} is not NORTH,EAST,RADIUS[,HEIGHT] in metres, such as 30,0,2,15"
            ) from None
        return obstacle.checked()

    def checked(self) -> Self:
        """Return the obstacle; raises InvalidArgumentError if its numbers are not possible."""
        if not (abs(self.north) <= _FAR and abs(self.east) <= _FAR):
            raise InvalidArgumentError(f"an obstacle must be within 100 km of home, got {self[:2]}")
        if not (0 < self.radius <= _FAR and self.height > 0):
            raise InvalidArgumentError(
                f"radius and height of an obstacle must be positive, got {self.radius} and {self.height}"
            )
        return self


class Cylinder(NamedTuple):
    """An obstacle in the local frame of a body: metres north, east, down."""

    north: float
    east: float
    radius: float
    top: float

    def distance_along(self, here: Point, ray: Point) -> float:
        """Return the metres along a ray (a unit vector) to the surface; infinite if it misses."""
        north, east = here[0] - self.north, here[1] - self.east
        flat = ray[0] * ray[0] + ray[1] * ray[1]
        outside = north * north + east * east - self.radius * self.radius
        if outside <= 0 and here[2] >= self.top:
            return 0.0
        distances = []
        half = north * ray[0] + east * ray[1]
        root = half * half - flat * outside
        if flat > _PARALLEL and root >= 0:
            wall = (-half - sqrt(root)) / flat
            if here[2] + wall * ray[2] >= self.top:
                distances.append(wall)
        if isfinite(self.top) and ray[2] > _PARALLEL:
            roof = (self.top - here[2]) / ray[2]
            if hypot(north + roof * ray[0], east + roof * ray[1]) <= self.radius:
                distances.append(roof)
        return min((distance for distance in distances if distance >= 0), default=inf)

    def distance_between(self, here: Point, bearing: float, half_width: float) -> float:
        """Return the horizontal distance to the surface within a sector; infinite if it is not in it.

        Args:
            here: The position.
            bearing: The middle of the sector, radians from north.
            half_width: Half of the width of the sector, in radians.
        """
        if here[2] < self.top:
            return inf
        north, east = self.north - here[0], self.east - here[1]
        distance = hypot(north, east)
        if distance <= self.radius:
            return 0.0
        off = abs(remainder(atan2(east, north) - bearing, tau))
        off = max(off - half_width, 0.0)
        if off > asin(self.radius / distance):
            return inf
        return distance * cos(off) - sqrt(max(self.radius**2 - (distance * sin(off)) ** 2, 0.0))

    def clearance_along(self, here: Point, direction: tuple[float, float], margin: float) -> float:
        """Return the metres that a body may move horizontally until it is `margin` from the surface.

        Args:
            here: The position.
            direction: North and east of the way, a unit vector.
            margin: Metres to keep from the surface.

        Returns:
            The distance; infinite if the way leads past the obstacle, over it or away from it.
        """
        if here[2] < self.top:
            return inf
        north, east = self.north - here[0], self.east - here[1]
        along = north * direction[0] + east * direction[1]
        aside = north * direction[1] - east * direction[0]
        reach = self.radius + margin
        if along <= 0 or abs(aside) >= reach:
            return inf
        return max(along - sqrt(reach * reach - aside * aside), 0.0)


class Surroundings:
    """The ground and the obstacles around one body, in its local frame."""

    def __init__(self) -> None:
        self.cylinders: list[Cylinder] = []

    def distance_along(self, here: Point, ray: Point) -> float:
        """Return the metres along a ray (a unit vector) to the ground or an obstacle, or infinity."""
        ground = max(-here[2], 0.0) / ray[2] if ray[2] > _PARALLEL else inf
        return min(ground, *(each.distance_along(here, ray) for each in self.cylinders), inf)

    def sectors(self, here: Point, heading: float, count: int) -> Iterator[float]:
        """Yield the distance of the nearest obstacle in each sector, clockwise from the heading."""
        width = tau / count
        for number in range(count):
            bearing = heading + number * width
            yield min(
                (each.distance_between(here, bearing, width / 2) for each in self.cylinders), default=inf
            )

    def clearance_along(self, here: Point, course: float, margin: float) -> float:
        """Return the metres on a course (radians) until a body is `margin` from an obstacle."""
        way = cos(course), sin(course)
        return min((each.clearance_along(here, way, margin) for each in self.cylinders), default=inf)


def turned(forward: Point, roll: float, pitch: float, yaw: float) -> Point:
    """Return a vector of the body (forward, right, down) as north, east, down."""
    x, y, z = forward
    y, z = y * cos(roll) - z * sin(roll), y * sin(roll) + z * cos(roll)
    x, z = x * cos(pitch) + z * sin(pitch), z * cos(pitch) - x * sin(pitch)
    return x * cos(yaw) - y * sin(yaw), x * sin(yaw) + y * cos(yaw), z
