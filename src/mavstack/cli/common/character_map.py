"""A map in characters: tracks in braille dots, vehicles as signs, north up, as large as its place allows.

A character holds two by four dots, so that a window of 60 by 20 characters has 120 by 80 of them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import cos, radians
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

Place: TypeAlias = tuple[float, float]  # latitude, longitude in degrees

#: The dots of a braille character by column and row.
_DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
_BLANK = 0x2800
_METRES_PER_DEGREE = 111_319.5
#: A map shows at least so many metres, so that a vehicle that stands still does not fill it.
_LEAST = 60.0
_MARGIN = 1.15
_NICE = (1, 2, 5)
_LONGEST_BAR = 0.4


@dataclass(slots=True)
class Marked:
    """Something on the map: its track, its sign and the style of both."""

    sign: str
    style: str
    track: Sequence[Place]
    place: Place | None = None


@dataclass(slots=True)
class Cell:
    """A character of the map and its style."""

    sign: str = " "
    style: str = ""
    dots: int = 0


@dataclass(slots=True)
class Map:
    """The finished map: rows of cells, and how long a bar of so many characters is in metres."""

    rows: list[list[Cell]] = field(default_factory=list)
    bar: int = 0
    bar_metres: int = 0


def draw_map(things: Sequence[Marked], columns: int, rows: int) -> Map:
    """Draw everything so that all of it is in view."""
    cells = [[Cell() for _ in range(columns)] for _ in range(rows)]
    places = [place for thing in things for place in (*thing.track, *([thing.place] if thing.place else []))]
    if not places or columns < 2 or rows < 1:
        return Map(cells)
    view = _View.around(places, columns, rows)
    for thing in things:
        for column, row in (view.dot(place) for place in _joined(thing.track)):
            if 0 <= column < 2 * columns and 0 <= row < 4 * rows:
                cell = cells[row // 4][column // 2]
                cell.dots |= _DOTS[column % 2][row % 4]
                cell.sign, cell.style = chr(_BLANK | cell.dots), thing.style
    for thing in things:
        if thing.place is not None:
            column, row = view.dot(thing.place)
            cell = cells[min(max(row // 4, 0), rows - 1)][min(max(column // 2, 0), columns - 1)]
            cell.sign, cell.style = thing.sign, f"bold {thing.style}"
    bar, metres = _bar(view.metres_per_dot, columns)
    return Map(cells, bar, metres)


@dataclass(frozen=True, slots=True)
class _View:
    latitude: float
    longitude: float
    metres_per_dot: float
    columns: int
    rows: int

    @classmethod
    def around(cls, places: Sequence[Place], columns: int, rows: int) -> _View:
        south, north = min(place[0] for place in places), max(place[0] for place in places)
        west, east = min(place[1] for place in places), max(place[1] for place in places)
        latitude, longitude = (south + north) / 2, (west + east) / 2
        height = max((north - south) * _METRES_PER_DEGREE, _LEAST)
        width = max((east - west) * _METRES_PER_DEGREE * cos(radians(latitude)), _LEAST)
        scale = max(width / (2 * columns), height / (4 * rows)) * _MARGIN
        return cls(latitude, longitude, scale, columns, rows)

    def dot(self, place: Place) -> tuple[int, int]:
        """The dot of a place: column from the left, row from the top."""
        north = (place[0] - self.latitude) * _METRES_PER_DEGREE
        east = (place[1] - self.longitude) * _METRES_PER_DEGREE * cos(radians(self.latitude))
        return (
            round(self.columns + east / self.metres_per_dot),
            round(2 * self.rows - north / self.metres_per_dot),
        )


def _joined(track: Sequence[Place]) -> Iterable[Place]:
    """The track with places between its own, so that it looks like a line."""
    for (north, east), (to_north, to_east) in zip(track, list(track)[1:], strict=False):
        for part in range(4):
            share = part / 4
            yield north + (to_north - north) * share, east + (to_east - east) * share
    yield from list(track)[-1:]


def _bar(metres_per_dot: float, columns: int) -> tuple[int, int]:
    """The longest bar of a round number of metres that fits into part of the width."""
    longest = metres_per_dot * 2 * columns * _LONGEST_BAR
    metres, power = 1, 1
    while power * _NICE[0] <= longest:
        metres = max(nice * power for nice in _NICE if nice * power <= longest)
        power *= 10
    return max(round(metres / (2 * metres_per_dot)), 1), metres
