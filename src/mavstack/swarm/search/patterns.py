"""Search patterns of the IAMSAR manual, as legs in metres north and east of the datum.

- *Expanding square*: a square spiral from the datum; legs of one, one, two, two, three, three … track
  spacings, all turns to the right. The first leg goes down the drift. A second search is turned by 45
  degrees.
- *Sector*: three triangles through the datum, nine legs as long as the radius; all turns are 120 degrees to
  the right, and there is none at the datum. A second search is turned by 30 degrees.
- *Parallel track*, *creeping line*: legs parallel to the long or the short side of a rectangle, half a
  spacing inside.
- *Track line*: along a route and back beside it.

The sweep width W is the width in which an object is found as often as beyond it one is missed. With a track
spacing S the coverage is C = W / S, and the probability that one search finds the object is 1 - exp(-C) for
a random search, which real ones exceed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.swarm.arrays import Points


def probability_of_detection(sweep_width: float, spacing: float, searches: int = 1) -> float:
    """Return the probability that a search finds an object that is in the area, 0 to 1.

    Args:
        sweep_width: Metres.
        spacing: Metres between tracks.
        searches: The number of independent searches of the area.
    """
    _check_positive(sweep_width=sweep_width, spacing=spacing)
    return 1.0 - math.exp(-searches * sweep_width / spacing)


def spacing_for(sweep_width: float, probability: float) -> float:
    """Return the track spacing in metres at which one search finds an object with a probability.

    Args:
        sweep_width: Metres.
        probability: More than 0 and less than 1.
    """
    _check_positive(sweep_width=sweep_width)
    if not 0.0 < probability < 1.0:
        raise InvalidArgumentError(f"probability must be more than 0 and less than 1, got {probability:g}")
    return -sweep_width / math.log1p(-probability)


def expanding_square(spacing: float, legs: int, *, bearing: float = 0.0) -> Points:
    """Return the corners of an expanding square, the datum first.

    Args:
        spacing: Metres between tracks.
        legs: The number of legs.
        bearing: Direction of the first leg in degrees.

    Returns:
        Metres north and east of the datum, an array of shape (legs + 1, 2).
    """
    _check_positive(spacing=spacing, legs=legs)
    lengths = [spacing * (1 + index // 2) for index in range(legs)]
    return _path(lengths, [bearing + 90.0 * index for index in range(legs)])


def sector(radius: float, *, bearing: float = 0.0) -> Points:
    """Return the corners of a sector search, the datum first and last.

    Args:
        radius: Metres from the datum to the corners.
        bearing: Direction of the first leg in degrees.

    Returns:
        Metres north and east of the datum, an array of shape (10, 2).
    """
    _check_positive(radius=radius)
    corners = [np.zeros(2)]
    for triangle in range(3):
        # Each triangle leaves the datum on the course of the leg that led there.
        first = bearing + 240.0 * triangle
        corners += [radius * _direction(first), radius * _direction(first + 60.0), np.zeros(2)]
    return np.array(corners)


def parallel_track(length: float, width: float, spacing: float, *, bearing: float = 0.0) -> Points:
    """Return the ends of legs parallel to the long side of a rectangle.

    Args:
        length: Metres of the side along the bearing.
        width: Metres of the side across it.
        spacing: Metres between tracks; the first is half of it inside.
        bearing: Direction of the first leg in degrees.

    Returns:
        Metres north and east of the rectangle's corner at the rear left, an array of shape (2 n, 2).
    """
    _check_positive(length=length, width=width, spacing=spacing)
    tracks = max(1, math.ceil(width / spacing - 1e-9))
    gap = width / tracks
    inside = min(spacing, length) / 2.0
    points = []
    for track in range(tracks):
        ends = [(inside, (track + 0.5) * gap), (length - inside, (track + 0.5) * gap)]
        points += ends if track % 2 == 0 else ends[::-1]
    return _turned(np.array(points), bearing)


def creeping_line(length: float, width: float, spacing: float, *, bearing: float = 0.0) -> Points:
    """Return the ends of legs parallel to the short side of a rectangle, from its likelier end.

    Args:
        length: Metres of the side along the bearing.
        width: Metres of the side across it.
        spacing: Metres between tracks.
        bearing: Direction in which the search advances in degrees.

    Returns:
        Metres north and east of the rectangle's corner at the rear left, an array of shape (2 n, 2).
    """
    across = parallel_track(width, length, spacing)
    return _turned(across[:, ::-1].copy(), bearing)


def track_line(route: Sequence[tuple[float, float]] | Points, spacing: float, *, sides: int = 1) -> Points:
    """Return the corners of a search along a route and back.

    Args:
        route: Metres north and east of each corner of the route.
        spacing: Metres between the route and the way beside it.
        sides: 1: there on the right and back on the left of the route; more: as many pairs of tracks.

    Returns:
        Metres north and east, an array of shape (n, 2).
    """
    _check_positive(spacing=spacing, sides=sides)
    line = np.asarray(route, dtype=float)
    if line.ndim != 2 or line.shape[0] < 2 or line.shape[1] != 2:
        raise InvalidArgumentError("route must have at least two corners, north and east")
    tracks = []
    for index in range(sides):
        beside = (index + 0.5) * spacing
        tracks += [offset_line(line, beside), offset_line(line, -beside)[::-1]]
    return np.vstack(tracks)


def offset_line(line: Points, right: float) -> Points:
    """Return a line at a distance to the right, with mitred corners."""
    legs = np.diff(line, axis=0)
    lengths = np.linalg.norm(legs, axis=1)
    if not (lengths > 0.0).all():
        raise InvalidArgumentError("route must not have a corner twice in a row")
    normals = np.column_stack((-legs[:, 1], legs[:, 0])) / lengths[:, None]
    before, after = np.vstack((normals[:1], normals)), np.vstack((normals, normals[-1:]))
    mitre = before + after
    # The minimum 0.2 limits the distance of the new corner from the line at sharp turns.
    mitre /= np.maximum((mitre * before).sum(axis=1), 0.2)[:, None]
    beside: Points = line + right * mitre
    return beside


def _path(lengths: Sequence[float], bearings: Sequence[float]) -> Points:
    steps = np.array(
        [length * _direction(bearing) for length, bearing in zip(lengths, bearings, strict=True)]
    )
    return np.vstack((np.zeros((1, 2)), np.cumsum(steps, axis=0)))


def _direction(bearing: float) -> Points:
    angle = math.radians(bearing)
    return np.array((math.cos(angle), math.sin(angle)))


def _turned(points: Points, bearing: float) -> Points:
    angle = math.radians(bearing)
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.column_stack(
        (cosine * points[:, 0] - sine * points[:, 1], sine * points[:, 0] + cosine * points[:, 1])
    )


def _check_positive(**values: float) -> None:
    for name, value in values.items():
        if not (math.isfinite(value) and value > 0):
            raise InvalidArgumentError(f"{name} must be finite and more than 0, got {value:g}")
