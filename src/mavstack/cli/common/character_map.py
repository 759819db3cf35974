"""A map in characters: tracks in braille dots, vehicles as symbols, north up, scaled to its space.

A character holds two by four dots, so a window of 60 by 20 characters has 120 by 80 of them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import cos, radians
from typing import TYPE_CHECKING, TypeAlias

from mavstack.geodesy import METRES_PER_DEGREE

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

Place: TypeAlias = tuple[float, float]  # latitude, longitude in degrees

#: The dots of a braille character by column and row.
_DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
_BLANK = 0x2800
#: Minimum extent of a map in metres, so that the track of a vehicle that does not move does not fill the map.
_MIN_EXTENT = 60.0
_MARGIN = 1.15
_ROUND_STEPS = (1, 2, 5)
#: Largest share of the width that the scale bar takes.
_MAX_BAR = 0.4


@dataclass(slots=True)
class MapObject:
    """An object on the map: its symbol, its style, its track and its place."""

    symbol: str
    style: str
    track: Sequence[Place]
    place: Place | None = None


@dataclass(slots=True)
class Cell:
    """A character of the map and its style."""

    symbol: str = " "
    style: str = ""
    dots: int = 0


@dataclass(slots=True)
class CharacterMap:
    """A finished map: rows of cells, and a scale bar with its length in characters and in metres."""

    rows: list[list[Cell]] = field(default_factory=list)
    bar: int = 0
    bar_metres: int = 0


def draw_map(objects: Sequence[MapObject], columns: int, rows: int) -> CharacterMap:
    """Draw a map of `columns` by `rows` characters that shows all objects."""
    cells = [[Cell() for _ in range(columns)] for _ in range(rows)]
    places = [place for each in objects for place in (*each.track, *([each.place] if each.place else []))]
    if not places or columns < 2 or rows < 1:
        return CharacterMap(cells)
    view = _View.around(places, columns, rows)
    for each in objects:
        for column, row in (view.dot(place) for place in _interpolated(each.track)):
            if 0 <= column < 2 * columns and 0 <= row < 4 * rows:
                cell = cells[row // 4][column // 2]
                cell.dots |= _DOTS[column % 2][row % 4]
                cell.symbol, cell.style = chr(_BLANK | cell.dots), each.style
    for each in objects:
        if each.place is not None:
            column, row = view.dot(each.place)
            cell = cells[min(max(row // 4, 0), rows - 1)][min(max(column // 2, 0), columns - 1)]
            cell.symbol, cell.style = each.symbol, f"bold {each.style}"
    bar, metres = _bar(view.metres_per_dot, columns)
    return CharacterMap(cells, bar, metres)


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
        height = max((north - south) * METRES_PER_DEGREE, _MIN_EXTENT)
        width = max((east - west) * METRES_PER_DEGREE * cos(radians(latitude)), _MIN_EXTENT)
        scale = max(width / (2 * columns), height / (4 * rows)) * _MARGIN
        return cls(latitude, longitude, scale, columns, rows)

    def dot(self, place: Place) -> tuple[int, int]:
        """Return the dot of a place: column from the left, row from the top."""
        north = (place[0] - self.latitude) * METRES_PER_DEGREE
        east = (place[1] - self.longitude) * METRES_PER_DEGREE * cos(radians(self.latitude))
        return (
            round(self.columns + east / self.metres_per_dot),
            round(2 * self.rows - north / self.metres_per_dot),
        )


def _interpolated(track: Sequence[Place]) -> Iterable[Place]:
    """Yield the track with intermediate places, so that it looks like a line."""
    for (north, east), (to_north, to_east) in zip(track, list(track)[1:], strict=False):
        for part in range(4):
            share = part / 4
            yield north + (to_north - north) * share, east + (to_east - east) * share
    yield from list(track)[-1:]


def _bar(metres_per_dot: float, columns: int) -> tuple[int, int]:
    """Return the longest bar of a round number of metres that fits into part of the width."""
    available = metres_per_dot * 2 * columns * _MAX_BAR
    metres, power = 1, 1
    while power * _ROUND_STEPS[0] <= available:
        metres = max(step * power for step in _ROUND_STEPS if step * power <= available)
        power *= 10
    return max(round(metres / (2 * metres_per_dot)), 1), metres
