"""Areas: outlines with obstacles, and the tracks that cover them.

The area is cut into parallel strips, one track spacing wide. In each strip the area is one interval or
several: concave outlines and obstacles divide it. Intervals of neighbouring strips that touch each other,
and no other, belong to one cell, which is flown back and forth (boustrophedon decomposition, Choset 2000).
The direction of the strips is the one with the fewest of them, since turns cost more than straight flight;
it is parallel to an edge of the outline.

An interval is as long as the area anywhere in its strip, so that slanted edges are covered too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.swarm.arrays import Points

Corner = tuple[float, float]
#: The two ends of a part of a line.
Interval = tuple[float, float]
#: Heights of a sweep that differ by less than this, in metres, are equal.
_SAME: Final = 1e-9
#: Maximum number of strips of an area; a larger number is probably a mistake in a unit.
MAX_STRIPS: Final = 10_000


@dataclass(frozen=True, slots=True)
class Area:
    """An outline, and the obstacles inside of it.

    Attributes:
        outline: Corners in metres north and east, in order, without repeating the first one.
        obstacles: Outlines of regions that are not covered.
    """

    outline: Sequence[Corner]
    obstacles: Sequence[Sequence[Corner]] = field(default=())

    def __post_init__(self) -> None:
        for name, ring in (("outline", self.outline), *(("obstacle", each) for each in self.obstacles)):
            corners = np.asarray(ring, dtype=float)
            if corners.ndim != 2 or corners.shape[0] < 3 or corners.shape[1] != 2:
                raise InvalidArgumentError(f"{name} must have at least three corners, north and east")
            if not np.isfinite(corners).all():
                raise InvalidArgumentError(f"{name} must have finite corners")
        if self.size <= 0.0:
            raise InvalidArgumentError("outline must enclose an area that is larger than its obstacles")

    @property
    def rings(self) -> tuple[Points, ...]:
        """The outline and the obstacles as arrays of shape (n, 2)."""
        return tuple(np.asarray(ring, dtype=float) for ring in (self.outline, *self.obstacles))

    @property
    def size(self) -> float:
        """The area in square metres, without the obstacles."""
        outline, *obstacles = (abs(_signed_area(ring)) for ring in self.rings)
        return outline - sum(obstacles)

    def best_bearing(self) -> float:
        """Return the direction of tracks, in degrees, for which the area needs the fewest."""
        outline = self.rings[0]
        edges = np.roll(outline, -1, axis=0) - outline
        bearings = np.degrees(np.arctan2(edges[:, 1], edges[:, 0])) % 180.0
        return float(min(bearings, key=lambda bearing: (_extent_across(outline, bearing), bearing)))


@dataclass(frozen=True, slots=True)
class Track:
    """A straight leg over an area.

    Attributes:
        start: Metres north and east of the end at which it begins.
        end: Metres north and east of the other end.
        cell: The number of its cell.
    """

    start: Corner
    end: Corner
    cell: int

    @property
    def length(self) -> float:
        """The length in metres."""
        return math.dist(self.start, self.end)

    def reversed(self) -> Track:
        """Return the track in the other direction."""
        return Track(self.end, self.start, self.cell)


def cover(area: Area, spacing: float, *, bearing: float | None = None) -> list[list[Track]]:
    """Return the tracks that cover an area, by cell.

    Args:
        area: The area.
        spacing: Largest distance between tracks in metres.
        bearing: Direction of the tracks in degrees; None: the one with the fewest tracks.

    Returns:
        The tracks of each cell, side by side, all in one direction.

    Raises:
        InvalidArgumentError: The spacing is not positive, or so small that the area has too many tracks.
    """
    if not (math.isfinite(spacing) and spacing > 0.0):
        raise InvalidArgumentError(f"spacing must be finite and more than 0 m, got {spacing:g}")
    direction = area.best_bearing() if bearing is None else bearing
    rings = [_to_sweep(ring, direction) for ring in area.rings]
    low, high = float(rings[0][:, 1].min()), float(rings[0][:, 1].max())
    strips = max(1, math.ceil((high - low) / spacing - _SAME))
    if strips > MAX_STRIPS:
        raise InvalidArgumentError(
            f"an area of {high - low:.0f} m needs {strips} tracks, at most {MAX_STRIPS} are allowed"
        )
    width = (high - low) / strips
    rows = [_strip_intervals(rings, low + index * width, width) for index in range(strips)]
    cells: list[list[Track]] = []
    for number, cell in enumerate(_cells(rows)):
        ends = [
            [(first, low + (row + 0.5) * width), (last, low + (row + 0.5) * width)]
            for row, first, last in cell
        ]
        flat = _from_sweep(np.array(ends).reshape(-1, 2), direction).reshape(-1, 2, 2)
        cells.append([Track((start[0], start[1]), (end[0], end[1]), number) for start, end in flat.tolist()])
    return cells


def _strip_intervals(rings: Sequence[Points], low: float, width: float) -> list[Interval]:
    """Return the extents of the connected parts that the area has in a strip.

    A part that an obstacle divides in the middle of the strip is several intervals, without the obstacle.
    """
    heights = {low + width * share for share in (_SAME, 0.5, 1.0 - _SAME)}
    for ring in rings:
        inside = ring[(ring[:, 1] > low) & (ring[:, 1] < low + width), 1]
        heights.update(float(height) + sign * 1e-6 * width for height in inside for sign in (-1.0, 1.0))
    rows = [_intervals(rings, height) for height in sorted(heights)]
    middle = _intervals(rings, low + 0.5 * width)
    return sorted(extent for part in _connected(rows) for extent in _extents(part, middle))


def _connected(rows: Sequence[Sequence[Interval]]) -> list[list[Interval]]:
    """Return the intervals of each connected part.

    Between two rows with as many intervals there is no corner, and the n-th of one continues in the n-th of
    the other. At a corner, where their number changes, those that touch each other are connected.
    """
    parts: dict[int, list[Interval]] = {}
    before: list[tuple[Interval, int]] = []
    for row in rows:
        present: list[tuple[Interval, int]] = []
        for index, interval in enumerate(row):
            if len(row) == len(before):
                linked = {before[index][1]}
            else:
                linked = {number for each, number in before if _touch(each, interval)}
            number = min(linked, default=len(parts) + sum(map(len, parts.values())))
            _merge(parts, number, linked)
            before, present = (
                [(each, number if old in linked else old) for each, old in known]
                for known in (before, present)
            )
            parts.setdefault(number, []).append(interval)
            present.append((interval, number))
        before = present
    return list(parts.values())


def _merge(parts: dict[int, list[Interval]], number: int, linked: set[int]) -> None:
    """Move the intervals of all linked parts to one of them."""
    for other in linked - {number}:
        parts[number] += parts.pop(other)


def _extents(part: Sequence[Interval], middle: Sequence[Interval]) -> list[Interval]:
    """Return the extent of a part, or one for each interval that it has in the middle of the strip.

    The others of its intervals belong to the nearest of those: the tip of an oblique corner touches none.
    """
    own = [each for each in middle if each in part]
    if len(own) < 2:
        return [(min(first for first, _ in part), max(last for _, last in part))]
    extents = []
    for index, (first, last) in enumerate(own):
        low = own[index - 1][1] if index else -math.inf
        high = own[index + 1][0] if index + 1 < len(own) else math.inf
        near = [each for each in part if _gap(each, (first, last)) <= min(_gap(each, one) for one in own)]
        extents.append((max(low, min(each[0] for each in near)), min(high, max(each[1] for each in near))))
    return extents


def _gap(one: Interval, other: Interval) -> float:
    """Return the distance between two intervals, 0 if they touch."""
    return max(one[0] - other[1], other[0] - one[1], 0.0)


def _intervals(rings: Sequence[Points], height: float) -> list[tuple[float, float]]:
    """Return the parts of a line that are inside the area, by the even-odd rule."""
    crossings: list[float] = []
    for ring in rings:
        after = np.roll(ring, -1, axis=0)
        crosses = (ring[:, 1] > height) != (after[:, 1] > height)
        begin, end = ring[crosses], after[crosses]
        share = (height - begin[:, 1]) / (end[:, 1] - begin[:, 1])
        crossings += (begin[:, 0] + share * (end[:, 0] - begin[:, 0])).tolist()
    crossings.sort()
    return [pair for pair in zip(crossings[::2], crossings[1::2], strict=True) if pair[1] > pair[0]]


def _cells(rows: Sequence[Sequence[tuple[float, float]]]) -> Iterator[list[tuple[int, float, float]]]:
    """Yield cells: runs of intervals in which each touches one of the row before, which touches no other."""
    # The key is the index of a cell's last interval in its row.
    open_cells: dict[int, list[tuple[int, float, float]]] = {}
    before: Sequence[tuple[float, float]] = ()
    for row, intervals in enumerate(rows):
        below = [[old for old, each in enumerate(before) if _touch(each, interval)] for interval in intervals]
        counts = [sum(old in each for each in below) for old in range(len(before))]
        going: dict[int, list[tuple[int, float, float]]] = {}
        for index, (first, last) in enumerate(intervals):
            alone = len(below[index]) == 1 and counts[below[index][0]] == 1
            cell = open_cells.pop(below[index][0]) if alone else []
            cell.append((row, first, last))
            going[index] = cell
        yield from open_cells.values()
        open_cells, before = going, intervals
    yield from open_cells.values()


def _touch(one: tuple[float, float], other: tuple[float, float]) -> bool:
    return one[0] < other[1] and other[0] < one[1]


def _to_sweep(points: Points, bearing: float) -> Points:
    """Return points as metres along and across a bearing."""
    angle = math.radians(bearing)
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.column_stack(
        (cosine * points[:, 0] + sine * points[:, 1], cosine * points[:, 1] - sine * points[:, 0])
    )


def _from_sweep(points: Points, bearing: float) -> Points:
    return _to_sweep(points, -bearing)


def _extent_across(points: Points, bearing: float) -> float:
    return round(float(np.ptp(_to_sweep(points, bearing)[:, 1])), 6)


def _signed_area(ring: Points) -> float:
    after = np.roll(ring, -1, axis=0)
    return float((ring[:, 0] * after[:, 1] - after[:, 0] * ring[:, 1]).sum() / 2.0)
