"""Shares of an area as connected regions of a grid, each around the start of its vehicle.

The division of `division` cuts one line of tracks, so a share lies where the line passes. Here each vehicle
searches the part of the area that is around it, as with DARP (Kapoutsis et al. 2017): every share is
connected, lies around the start of its vehicle, and is as large as the vehicle's speed and
endurance ask for. DARP finds such shares by weights of a distance field; here regions grow from the starts
in turns, and then cells at their borders change hands along the chain of regions between the largest share
and the smallest one. A cell that holds its region together is not given away.

A cell is a piece of a track, `spacing` long, so that the shares are flown along the tracks of `cover`.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.search.areas import Track

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from mavstack.swarm.search.areas import Corner
    from mavstack.swarm.search.division import Searcher

#: Maximum number of cells of a grid, which bounds the time of the calculation.
MAX_CELLS: Final = 20_000
#: Maximum number of exchanges of border cells between vehicles, per cell of the grid.
_EXCHANGES: Final = 4


@dataclass(frozen=True, slots=True)
class _Cell:
    """A piece of a track.

    Attributes:
        row: The number of its strip.
        first: Metres along the track at which it begins.
        last: Metres at which it ends.
        track: The track of which it is a piece.
    """

    row: int
    first: float
    last: float
    track: Track

    @property
    def length(self) -> float:
        return self.last - self.first

    @property
    def centre(self) -> Corner:
        return _along(self.track, 0.5 * (self.first + self.last) - _begin(self.track))


def divide_by_grid(
    cells: Sequence[Sequence[Track]], searchers: Sequence[Searcher], spacing: float
) -> list[list[list[Track]]]:
    """Divide an area into connected shares around the starts of the vehicles.

    Args:
        cells: The tracks of each cell of the area, all in one direction, as `cover` returns them.
        searchers: The vehicles; a vehicle without a start gets one at the border of the area.
        spacing: Metres between tracks, and the length of a cell of the grid.

    Returns:
        For each vehicle the tracks of its share by cells, for `order_tracks`.

    Raises:
        InvalidArgumentError: There is no vehicle, or the grid has more than `MAX_CELLS` cells, or fewer
            cells than vehicles.
    """
    if not searchers:
        raise InvalidArgumentError("an area must be divided among at least one vehicle")
    grid = _grid(cells, spacing)
    if not len(searchers) <= len(grid) <= MAX_CELLS:
        raise InvalidArgumentError(
            f"a grid of {len(grid)} cells cannot be divided among {len(searchers)} vehicles: "
            f"at least one cell for each and at most {MAX_CELLS} are possible"
        )
    regions = _Regions(grid, _neighbours(grid), [each.speed * each.endurance for each in searchers])
    regions.grow(_seeds(grid, searchers))
    regions.balance()
    return [_runs([grid[cell] for cell in sorted(region)]) for region in regions.members]


class _Regions:
    """The regions of a grid while they are made."""

    def __init__(
        self, grid: Sequence[_Cell], near: Sequence[Sequence[int]], weights: Sequence[float]
    ) -> None:
        self._grid, self._near = grid, near
        self._weights = weights
        self.members: list[set[int]] = [set() for _ in weights]
        self._owner = [-1] * len(grid)
        self._loads = [0.0] * len(weights)
        self._seeds: list[int] = []

    def grow(self, seeds: Sequence[int]) -> None:
        """Let the regions take free cells in turns: the smallest one takes the cell nearest to its seed."""
        self._seeds = list(seeds)
        for region, seed in enumerate(seeds):
            self._move(seed, region)
        growing = set(range(len(seeds)))
        while growing:
            region = min(growing, key=lambda each: (self._loads[each], each))
            free = {other for cell in self.members[region] for other in self._near[cell]}
            free = {cell for cell in free if self._owner[cell] < 0}
            if free:
                centre = self._grid[seeds[region]].centre
                self._move(min(free, key=lambda cell: (self._away(cell, centre), cell)), region)
            else:
                growing.discard(region)
        for cell, owner in enumerate(self._owner):  # cells that no seed can reach
            if owner < 0:
                self._flood(cell, min(range(len(seeds)), key=lambda each: (self._loads[each], each)))

    def balance(self) -> None:
        """Exchange cells at borders until no exchange makes the shares more equal."""
        for _ in range(_EXCHANGES * len(self._grid)):
            by_load = sorted(range(len(self.members)), key=lambda each: (self._loads[each], each))
            if not any(
                self._pass_on(high, low)
                for high in reversed(by_load)
                for low in by_load
                if self._loads[high] > self._loads[low]
            ):
                return

    def _pass_on(self, high: int, low: int) -> bool:
        """Pass a cell along the chain of regions from one to another; return False if that helps nothing."""
        chain = self._chain(high, low)
        if chain is None:
            return False
        steps: list[tuple[int, int, int]] = []
        before = max(self._loads[high], self._loads[low])
        for giver, taker in pairwise(chain):
            cell = self._border_cell(giver, taker)
            if cell is None:
                break
            steps.append((cell, giver, taker))
            self._move(cell, taker)
        complete = len(steps) == len(chain) - 1
        if complete and max(self._loads[high], self._loads[low]) < before - 1e-9:
            return True
        for cell, giver, _ in reversed(steps):
            self._move(cell, giver)
        return False

    def _chain(self, high: int, low: int) -> list[int] | None:
        """Return the regions on the shortest way of neighbours from one region to another."""
        before: dict[int, int] = {high: high}
        queue = deque([high])
        while queue:
            region = queue.popleft()
            if region == low:
                chain = [low]
                while chain[-1] != high:
                    chain.append(before[chain[-1]])
                return chain[::-1]
            for other in sorted(self._touching(region) - before.keys()):
                before[other] = region
                queue.append(other)
        return None

    def _touching(self, region: int) -> set[int]:
        return {self._owner[near] for cell in self.members[region] for near in self._near[cell]} - {region}

    def _border_cell(self, giver: int, taker: int) -> int | None:
        """Return the cell nearest to the taker's seed that the giver can spare."""
        centre = self._grid[self._seeds[taker]].centre
        border = [
            cell
            for cell in self.members[giver]
            if any(self._owner[near] == taker for near in self._near[cell])
        ]
        # The seed is passed on last: where starts are close together, one seed can enclose another.
        seed = self._seeds[giver]
        for cell in sorted(border, key=lambda each: (each == seed, self._away(each, centre), each)):
            if len(self.members[giver]) > 1 and self._is_connected_without(giver, cell):
                return cell
        return None

    def _is_connected_without(self, region: int, cell: int) -> bool:
        around = [near for near in self._near[cell] if self._owner[near] == region]
        if len(around) < 2:
            return True
        reached, queue = {around[0]}, deque(around[:1])
        wanted = set(around)
        while queue:
            for near in self._near[queue.popleft()]:
                if near != cell and near not in reached and self._owner[near] == region:
                    reached.add(near)
                    queue.append(near)
            if wanted <= reached:
                return True
        return False

    def _flood(self, cell: int, region: int) -> None:
        queue = deque([cell])
        while queue:
            here = queue.popleft()
            if self._owner[here] < 0:
                self._move(here, region)
                queue.extend(self._near[here])

    def _move(self, cell: int, region: int) -> None:
        owner = self._owner[cell]
        if owner >= 0:
            self.members[owner].discard(cell)
            self._loads[owner] -= self._grid[cell].length / self._weights[owner]
        self._owner[cell] = region
        self.members[region].add(cell)
        self._loads[region] += self._grid[cell].length / self._weights[region]

    def _away(self, cell: int, place: Corner) -> float:
        return math.dist(self._grid[cell].centre, place)


def _grid(cells: Sequence[Sequence[Track]], spacing: float) -> list[_Cell]:
    """Return the cells of the grid: pieces of all tracks, cut at multiples of the spacing."""
    rows: dict[int, list[Track]] = {}
    tracks = [track for cell in cells for track in cell if track.length > 0.0]
    for track in tracks:
        rows.setdefault(round(_across(track, tracks[0]) / spacing * 2.0), []).append(track)
    found: list[_Cell] = []
    for row, key in enumerate(sorted(rows)):
        for track in sorted(rows[key], key=_begin):
            begin, end = _begin(track), _begin(track) + track.length
            first = math.floor(begin / spacing)
            cuts = [spacing * index for index in range(first + 1, math.ceil(end / spacing))]
            # A piece shorter than a quarter of a cell is joined to its neighbour.
            inner = [cut for cut in cuts if begin + spacing / 4.0 < cut < end - spacing / 4.0]
            edges = [begin, *inner, end]
            found += [_Cell(row, low, high, track) for low, high in pairwise(edges)]
    return found


def _neighbours(grid: Sequence[_Cell]) -> list[list[int]]:
    """Return the neighbours of each cell: on its track, and those in the next strips beside it."""
    rows: dict[int, list[int]] = {}
    for index, cell in enumerate(grid):
        rows.setdefault(cell.row, []).append(index)
    near: list[list[int]] = [[] for _ in grid]
    for index, cell in enumerate(grid):
        for other in rows[cell.row]:
            if other != index and grid[other].track is cell.track and _touches(cell, grid[other]):
                near[index].append(other)
        for other in rows.get(cell.row + 1, ()):
            if grid[other].first < cell.last and cell.first < grid[other].last:
                near[index].append(other)
                near[other].append(index)
    return near


def _touches(one: _Cell, other: _Cell) -> bool:
    return one.first == other.last or one.last == other.first


def _seeds(grid: Sequence[_Cell], searchers: Sequence[Searcher]) -> list[int]:
    """Return the first cell of each vehicle: the nearest to its start that no other one has."""
    taken: list[int] = []
    for index, searcher in enumerate(searchers):
        free = [cell for cell in range(len(grid)) if cell not in set(taken)]
        if searcher.start is None:  # without a start position, seeds are spread along the tracks
            wanted = (2 * index + 1) * len(grid) // (2 * len(searchers))
            taken.append(min(free, key=lambda cell: (abs(cell - wanted), cell)))
        else:
            start = searcher.start
            taken.append(min(free, key=lambda cell: (math.dist(start, grid[cell].centre), cell)))
    return taken


def _runs(cells: Iterable[_Cell]) -> list[list[Track]]:
    """Return the tracks of a share by cell: consecutive pieces are one track, rows that touch one cell."""
    runs: list[tuple[int, float, float, Track]] = []
    for cell in sorted(cells, key=lambda each: (each.row, each.first)):
        if runs and runs[-1][0] == cell.row and runs[-1][2] == cell.first and runs[-1][3] is cell.track:
            runs[-1] = (cell.row, runs[-1][1], cell.last, cell.track)
        else:
            runs.append((cell.row, cell.first, cell.last, cell.track))
    groups: list[list[tuple[int, float, float, Track]]] = []
    for run in runs:
        for group in groups:
            last = group[-1]
            if last[0] == run[0] - 1 and last[1] < run[2] and run[1] < last[2]:
                group.append(run)
                break
        else:
            groups.append([run])
    return [[_piece(run[3], run[1], run[2], number) for run in group] for number, group in enumerate(groups)]


def _piece(track: Track, first: float, last: float, number: int) -> Track:
    begin = _begin(track)
    return Track(_along(track, first - begin), _along(track, last - begin), number)


def _along(track: Track, metres: float) -> Corner:
    share = metres / track.length
    return (
        track.start[0] + share * (track.end[0] - track.start[0]),
        track.start[1] + share * (track.end[1] - track.start[1]),
    )


def _begin(track: Track) -> float:
    """Return the metres along the direction of the tracks at which one begins."""
    north, east = _direction(track)
    return round(track.start[0] * north + track.start[1] * east, 6)


def _across(track: Track, first: Track) -> float:
    north, east = _direction(first)
    return (track.start[1] - first.start[1]) * north - (track.start[0] - first.start[0]) * east


def _direction(track: Track) -> tuple[float, float]:
    return (track.end[0] - track.start[0]) / track.length, (track.end[1] - track.start[1]) / track.length
