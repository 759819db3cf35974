"""Formations: the slots of a group of vehicles around its leader.

A slot is an offset from the leader in metres: forward along the leader's course, to the right of it, and
up. The course is the direction of the leader's motion over ground, not its heading, since a vehicle in wind
points elsewhere than it moves. Slot 0 is the leader's own in every formation that has a leader; `circle`,
`sphere`, `grid` and `text` are centred instead, and their leader is the centre of the formation, at which
no vehicle has to be.

`spacing` is the distance of neighbours. With `layer_spacing` the slots are also at different heights: slot
i is i mod `layers` layers above the lowest one, so that neighbours are apart although they lose their
positions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.block_letters import text_points
from mavstack.swarm.separation import VERTICAL_FACTOR

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from mavstack.swarm.arrays import Points

#: Angle between successive vehicles on the spiral of a sphere, in radians: the golden angle.
_GOLDEN_ANGLE: Final = math.pi * (3.0 - math.sqrt(5.0))
#: Maximum number of vehicles of one formation: about the system ids of four networks.
MAX_VEHICLES: Final = 1000


@dataclass(frozen=True, slots=True)
class Formation:
    """A shape with its measures.

    Attributes:
        name: The name of a shape, one of `FORMATIONS`.
        spacing: Metres between neighbours.
        angle: Degrees between the course and an arm of a wedge or an echelon, 90 is abeam.
        rotation: Degrees by which the whole formation is turned clockwise.
        layers: The number of height layers.
        layer_spacing: Metres between height layers; 0: all slots are at one height.
        text: The text of the formation `text`.
        points: The offsets of the formation `points`: metres forward, right, up.
    """

    name: str
    spacing: float = 8.0
    angle: float = 45.0
    rotation: float = 0.0
    layers: int = 1
    layer_spacing: float = 0.0
    text: str = ""
    points: Sequence[tuple[float, float, float]] = field(default=())

    def __post_init__(self) -> None:
        if self.name not in FORMATIONS:
            raise InvalidArgumentError(f"formation must be one of {', '.join(FORMATIONS)}, got {self.name!r}")
        for name, value, low in (("spacing", self.spacing, 0.1), ("layer_spacing", self.layer_spacing, 0.0)):
            if not (math.isfinite(value) and value >= low):
                raise InvalidArgumentError(f"{name} must be at least {low:g} m, got {value:g}")
        if not (0.0 < self.angle <= 90.0 and math.isfinite(self.rotation)):
            raise InvalidArgumentError(
                f"angle must be more than 0 and at most 90 degrees, got {self.angle:g}"
            )
        if self.layers < 1:
            raise InvalidArgumentError(f"layers must be at least 1, got {self.layers}")

    def offsets(self, count: int) -> Points:
        """Return the slots of `count` vehicles.

        Args:
            count: The number of vehicles, 1 to 1,000.

        Returns:
            An array of shape (count, 3): metres forward, right and up of the leader.

        Raises:
            InvalidArgumentError: `count` is out of range, or the formation `points` has another number of
                points.
        """
        if not 1 <= count <= MAX_VEHICLES:
            raise InvalidArgumentError(f"count must be 1 to {MAX_VEHICLES}, got {count}")
        slots = _turned(np.asarray(_SHAPES[self.name](self, count), dtype=float), self.rotation)
        layer = np.arange(count) % self.layers
        slots[:, 2] += layer * self.layer_spacing
        return slots


def default_spacing(name: str, planned_distance: float) -> float:
    """Return the spacing in metres at which any members can exchange their slots in straight lines.

    Args:
        name: The name of a shape; upright ones are larger, since heights count less.
        planned_distance: Metres that a plan keeps between two vehicles.
    """
    spacing = float(math.ceil(planned_distance * math.sqrt(2.0)))
    return spacing * VERTICAL_FACTOR if name in _UPRIGHT else spacing


def rotate_to_course(offsets: Points, course: float) -> Points:
    """Return offsets forward, right, up as metres north, east, up.

    Args:
        offsets: An array of shape (n, 3).
        course: Direction of the leader's motion in degrees, clockwise from north.
    """
    return _turned(np.asarray(offsets, dtype=float), course)


def _turned(points: Points, degrees: float) -> Points:
    angle = math.radians(degrees)
    cosine, sine = math.cos(angle), math.sin(angle)
    turned = points.copy()
    turned[:, 0] = cosine * points[:, 0] - sine * points[:, 1]
    turned[:, 1] = sine * points[:, 0] + cosine * points[:, 1]
    return turned


def _sides(count: int) -> tuple[Points, Points]:
    """Return the rank behind the leader (0, 1, 1, 2, 2 …) and the side (0, 1, -1, 1, -1 …) of each slot."""
    index = np.arange(count)
    rank = (index + 1) // 2
    side = np.where(index == 0, 0.0, np.where(index % 2 == 1, 1.0, -1.0))
    return rank.astype(float), side


def _line(formation: Formation, count: int) -> Points:
    rank, side = _sides(count)
    return _columns(np.zeros(count), rank * side * formation.spacing)


def _column(formation: Formation, count: int) -> Points:
    return _columns(-np.arange(count, dtype=np.float64) * formation.spacing, np.zeros(count))


def _wedge(formation: Formation, count: int) -> Points:
    rank, side = _sides(count)
    angle = math.radians(formation.angle)
    back, across = math.cos(angle), math.sin(angle)
    # The two vehicles of one rank are `2 * across * stretch` apart, which must not be less than the spacing.
    stretch = formation.spacing * max(1.0, 0.5 / across)
    return _columns(-rank * back * stretch, side * rank * across * stretch)


def _echelon(formation: Formation, count: int) -> Points:
    rank = np.arange(count, dtype=float) * formation.spacing
    angle = math.radians(formation.angle)
    return _columns(-rank * math.cos(angle), rank * math.sin(angle))


def _diamond(formation: Formation, count: int) -> Points:
    """Return rings of a lattice that stands on its corner, the leader at the front corner."""
    edge = math.ceil(math.sqrt(count))
    step = formation.spacing / math.sqrt(2.0)
    nodes = [(i + j, i - j) for i in range(edge) for j in range(edge)]
    nodes.sort(key=lambda node: (node[0], abs(node[1]), -node[1]))
    back, across = np.array(nodes[:count], dtype=float).T
    return _columns(-back * step, across * step)


def _grid(formation: Formation, count: int) -> Points:
    columns = math.ceil(math.sqrt(count))
    rows = math.ceil(count / columns)
    index = np.arange(count)
    forward: Points = (rows - 1) / 2.0 - (index // columns).astype(np.float64)
    right: Points = (index % columns).astype(np.float64) - (columns - 1) / 2.0
    return _columns(forward * formation.spacing, right * formation.spacing)


def _circle(formation: Formation, count: int) -> Points:
    if count == 1:
        return np.zeros((1, 3))
    radius = formation.spacing / (2.0 * math.sin(math.pi / count))
    angle = np.arange(count) * (2.0 * math.pi / count)
    return _columns(radius * np.cos(angle), radius * np.sin(angle))


def _sphere(formation: Formation, count: int) -> Points:
    """Return points of a Fibonacci spiral, on a sphere as small as the spacing allows."""
    if count == 1:
        return np.zeros((1, 3))
    index = np.arange(count) + 0.5
    up = 1.0 - 2.0 * index / count
    across = np.sqrt(1.0 - up * up)
    angle = index * _GOLDEN_ANGLE
    unit = np.column_stack((across * np.cos(angle), across * np.sin(angle), up))
    nearest = _nearest_distance(unit)
    points: Points = unit * (formation.spacing / nearest)
    return points


def _text(formation: Formation, count: int) -> Points:
    points = text_points(formation.text, count)
    points = points * (formation.spacing / _nearest_distance(points))
    return np.column_stack((np.zeros(count), points[:, 0], points[:, 1]))


def _points(formation: Formation, count: int) -> Points:
    if len(formation.points) != count:
        raise InvalidArgumentError(f"points has {len(formation.points)} points for {count} vehicles")
    return np.array(formation.points, dtype=float).reshape(count, 3)


def _columns(forward: Points, right: Points) -> Points:
    return np.column_stack((forward, right, np.zeros(len(forward))))


def _nearest_distance(points: Points) -> float:
    """Return the distance of the two points that are nearest to each other; 1 of a single point."""
    if len(points) < 2:
        return 1.0
    between = np.linalg.norm(points[:, None] - points[None], axis=2)
    np.fill_diagonal(between, np.inf)
    return float(between.min())


_SHAPES: Final[Mapping[str, Callable[[Formation, int], Points]]] = MappingProxyType(
    {
        "line": _line,
        "column": _column,
        "wedge": _wedge,
        "echelon": _echelon,
        "diamond": _diamond,
        "grid": _grid,
        "circle": _circle,
        "sphere": _sphere,
        "text": _text,
        "points": _points,
    }
)
#: Formations with vehicles above each other, which need more distance.
_UPRIGHT: Final = frozenset({"sphere", "text"})
#: The names of the formations, with a line about each.
FORMATIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "line": "abeam of the leader, to the right and left in turn",
        "column": "one behind the other",
        "wedge": "two arms behind the leader, at an angle",
        "echelon": "one arm behind the leader, to the right at an angle",
        "diamond": "a square that stands on its corner, the leader at the front",
        "grid": "rows and columns around the centre",
        "circle": "a ring around the centre",
        "sphere": "a sphere around the centre",
        "text": "block letters that face the direction of motion",
        "points": "slots of your own: metres forward, right, up",
    }
)
