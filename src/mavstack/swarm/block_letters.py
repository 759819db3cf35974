"""Block letters: points along the strokes of a text, for formations and shows.

A letter is a few strokes on a grid of four by six units. The points are spread over all strokes in
proportion to their lengths, so that any number of vehicles draws the text, and more of them draw it more
clearly.
"""

from __future__ import annotations

from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.swarm.arrays import Points

#: Width of a letter, and of the gap after it, in units of the grid.
_WIDTH: Final = 4
_GAP: Final = 2
#: Number of offsets along the strokes that are tried for the first point, to find the largest distance
#: between points: where two strokes cross, points can be too close.
_PHASES: Final = 16
#: Strokes of each letter: points "xy" joined by lines, strokes separated by spaces.
_STROKES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "A": "002640 1232",
        "B": "000636454433 0333424110 0010",
        "C": "45361605011030 3041",
        "D": "00062644422000",
        "E": "46060040 0333",
        "F": "000646 0333",
        "G": "453616050110304143 4323",
        "H": "0006 4046 0343",
        "I": "1030 1636 2026",
        "J": "4641301001",
        "K": "0006 460340",
        "L": "060040",
        "M": "0006234640",
        "N": "00064046",
        "O": "103041453616050110",
        "P": "00063645443303",
        "Q": "103041453616050110 2240",
        "R": "00063645443303 2340",
        "S": "4536160504134342 42413010 1001",
        "T": "0646 2026",
        "U": "060110304146",
        "V": "062046",
        "W": "0610233046",
        "X": "0046 0640",
        "Y": "062346 2320",
        "Z": "06460040",
        "0": "103041453616050110 0145",
        "1": "052620 1030",
        "2": "05163645440040",
        "3": "051636454433 33424130 301001 3313",
        "4": "300602 0242",
        "5": "46060333 33424130 301001",
        "6": "4536160501103041 41423303",
        "7": "064610",
        "8": "1333444536160504 0413 1302011030414233",
        "9": "4433130405163645 45413010",
        "-": "1333",
        "+": "1333 2224",
        "!": "2622 2120",
        ".": "2021",
        " ": "",
    }
)


def text_points(text: str, count: int) -> Points:
    """Return `count` points along the strokes of a text.

    Args:
        text: Latin letters, digits, spaces and - + ! . in one line.
        count: The number of points.

    Returns:
        An array of shape (count, 2): units to the right and up, around the centre of the text.

    Raises:
        InvalidArgumentError: The text is empty or has a character without strokes.
    """
    segments = _segments(text)
    if not len(segments):
        raise InvalidArgumentError("text must have at least one letter")
    phases = [_along(segments, count, phase / _PHASES) for phase in range(_PHASES)]
    points = max(phases, key=_nearest_distance)
    nodes = segments.reshape(-1, 2)
    centred: Points = points - (nodes.min(axis=0) + nodes.max(axis=0)) / 2.0
    return centred


def _along(segments: Points, count: int, phase: float) -> Points:
    """Return points at equal distances along all strokes."""
    lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    ends = np.cumsum(lengths)
    place = (np.arange(count) + phase) * (ends[-1] / count)
    index = np.minimum(np.searchsorted(ends, place), len(segments) - 1)
    share = ((place - (ends - lengths)[index]) / lengths[index])[:, None]
    points: Points = segments[index, 0] * (1.0 - share) + segments[index, 1] * share
    return points


def _nearest_distance(points: Points) -> float:
    between = np.linalg.norm(points[:, None] - points[None], axis=2)
    np.fill_diagonal(between, np.inf)
    return float(between.min())


def _segments(text: str) -> Points:
    """Return the lines of all letters, each once, as an array of shape (n, 2, 2)."""
    found: dict[tuple[tuple[int, int], ...], None] = {}
    for position, letter in enumerate(text.upper()):
        if letter not in _STROKES:
            raise InvalidArgumentError(f"text has {letter!r}, for which there are no strokes")
        left = position * (_WIDTH + _GAP)
        for stroke in _STROKES[letter].split():
            nodes = [(left + int(x), int(y)) for x, y in zip(stroke[::2], stroke[1::2], strict=False)]
            for ends in pairwise(nodes):
                if ends[0] != ends[1]:
                    found.setdefault(tuple(sorted(ends)))
    return np.array(list(found), dtype=float).reshape(-1, 2, 2)
