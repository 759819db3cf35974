"""Shares: the order in which tracks are flown, and their division among several vehicles.

The cells of an area are flown one after the other, each entered at the nearest of its four corners, so that
the way between cells is short. The result is one line of tracks. It is cut into consecutive pieces whose
times are in the proportion of the vehicles' endurance: a share is one connected part of the area, and all
vehicles end at the same time. A cut may fall within a track.

A wing cannot turn on the spot. With a turn radius, the tracks of a cell are interleaved: every k-th one is
flown, so that two consecutive ones are at least two radii apart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.search.areas import Track

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.swarm.search.areas import Corner

#: A track is cut for two vehicles only if both pieces are longer than this, in metres.
_SHORTEST_PIECE: Final = 0.5


@dataclass(frozen=True, slots=True)
class Searcher:
    """A vehicle that takes a share.

    Attributes:
        speed: Metres per second along the tracks.
        endurance: Its time in the air relative to the others; shares are proportional to speed times
            endurance.
        start: Metres north and east of its start; None: the first corner of its share.
    """

    speed: float = 5.0
    endurance: float = 1.0
    start: Corner | None = None

    def __post_init__(self) -> None:
        for name, value in (("speed", self.speed), ("endurance", self.endurance)):
            if not (math.isfinite(value) and value > 0.0):
                raise InvalidArgumentError(f"{name} must be finite and more than 0, got {value:g}")


def order_tracks(
    cells: Sequence[Sequence[Track]], start: Corner | None = None, *, turn_radius: float = 0.0
) -> list[Track]:
    """Return the tracks of all cells in the order and direction in which one vehicle flies them.

    Args:
        cells: The tracks of each cell, as `cover` returns them.
        start: Metres north and east from where the vehicle comes; None: the first corner of the first cell.
        turn_radius: Metres; tracks are interleaved so that a wing can turn from one to the next.
    """
    waiting = [list(cell) for cell in cells if cell]
    here = start or (waiting[0][0].start if waiting else (0.0, 0.0))
    ordered: list[Track] = []
    while waiting:
        choices = [
            (math.dist(here, line[0].start), number, line)
            for number, cell in enumerate(waiting)
            for line in _ways_through(cell, turn_radius)
        ]
        _, number, line = min(choices, key=lambda choice: choice[:2])
        del waiting[number]
        ordered += line
        here = line[-1].end
    return ordered


def divide(tracks: Sequence[Track], searchers: Sequence[Searcher]) -> list[list[Track]]:
    """Cut a line of tracks into a share for each vehicle.

    Args:
        tracks: The tracks in the order of `order_tracks`.
        searchers: The vehicles; the shares are assigned so that the ways to their first corners are short.

    Returns:
        The tracks of each vehicle, in the order of `searchers`.

    Raises:
        InvalidArgumentError: There is no vehicle.
    """
    if not searchers:
        raise InvalidArgumentError("an area must be divided among at least one vehicle")
    order = _order_along(tracks, searchers)
    weights = [searchers[index].speed * searchers[index].endurance for index in order]
    total = sum(track.length for track in tracks)
    shares: list[list[Track]] = [[] for _ in searchers]
    rest = list(tracks)
    for index, weight in zip(order, weights, strict=True):
        shares[index], rest = _take(rest, total * weight / sum(weights))
    shares[order[-1]] += rest  # tracks that are left by rounding errors
    return shares


def _take(tracks: list[Track], length: float) -> tuple[list[Track], list[Track]]:
    """Return the first metres of a line of tracks, and what is left."""
    taken: list[Track] = []
    for index, track in enumerate(tracks):
        if length < track.length - _SHORTEST_PIECE:
            if length <= _SHORTEST_PIECE:
                return taken, tracks[index:]
            first, second = _cut(track, length)
            return [*taken, first], [second, *tracks[index + 1 :]]
        taken.append(track)
        length -= track.length
    return taken, []


def _cut(track: Track, length: float) -> tuple[Track, Track]:
    share = length / track.length
    middle = tuple(first + share * (last - first) for first, last in zip(track.start, track.end, strict=True))
    place = (middle[0], middle[1])
    return Track(track.start, place, track.cell), Track(place, track.end, track.cell)


def _order_along(tracks: Sequence[Track], searchers: Sequence[Searcher]) -> list[int]:
    """Return the vehicles in the order in which their starts are passed by the line of tracks."""
    ends = [0.0]
    for track in tracks:
        ends.append(ends[-1] + track.length)

    def place(index: int) -> tuple[float, int]:
        start = searchers[index].start
        if start is None or not tracks:
            return math.inf, index
        nearest = min(range(len(tracks)), key=lambda each: math.dist(start, tracks[each].start))
        return ends[nearest], index

    return sorted(range(len(searchers)), key=place)


def _ways_through(cell: Sequence[Track], turn_radius: float) -> list[list[Track]]:
    """Return the four ways to fly a cell: from either side, beginning in either direction."""
    ways = []
    for side in (list(cell), list(cell)[::-1]):
        rows = _interleaved(side, turn_radius)
        ways += [_back_and_forth(rows, first_reversed) for first_reversed in (False, True)]
    return ways


def _back_and_forth(rows: Sequence[Track], first_reversed: bool) -> list[Track]:
    turned = [(index % 2 == 1) != first_reversed for index in range(len(rows))]
    return [track.reversed() if turn else track for turn, track in zip(turned, rows, strict=True)]


def _interleaved(rows: list[Track], turn_radius: float) -> list[Track]:
    """Return rows so that consecutive ones are two radii apart: 0, k, 1, k + 1 … in blocks of 2 k - 1."""
    if turn_radius <= 0.0 or len(rows) < 3:
        return rows
    gap = _row_distance(rows)
    skip = max(1, math.ceil(2.0 * turn_radius / gap - 1e-9) + 1)
    skip = min(skip, (len(rows) + 1) // 2)
    if skip <= 2:
        return rows
    ordered: list[Track] = []
    for begin in range(0, len(rows), 2 * skip - 1):
        block = rows[begin : begin + 2 * skip - 1]
        for index in range(skip):
            ordered += block[index : index + 1] + block[index + skip : index + skip + 1]
    return ordered


def _row_distance(rows: Sequence[Track]) -> float:
    """Return the distance of the lines of the first two rows."""
    first, second = rows[0], rows[1]
    along = (first.end[0] - first.start[0], first.end[1] - first.start[1])
    apart = (second.start[0] - first.start[0], second.start[1] - first.start[1])
    length = math.hypot(*along)
    return abs(along[0] * apart[1] - along[1] * apart[0]) / length if length else math.hypot(*apart)
