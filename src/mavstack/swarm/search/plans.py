"""A search around a point by several vehicles: a pattern, divided into the missions of the vehicles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.search.areas import Area, Track, cover
from mavstack.swarm.search.division import Searcher, divide, order_tracks
from mavstack.swarm.search.missions import search_mission
from mavstack.swarm.search.patterns import expanding_square, sector

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mavstack.geodesy import LocalFrame
    from mavstack.services.mission import MissionItem
    from mavstack.swarm.arrays import Points
    from mavstack.swarm.search.missions import MissionOptions

#: The names of the search patterns, with a line about each.
PATTERNS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "parallel": "tracks along the bearing over a square, for a place that is not known well",
        "creeping": "tracks across the bearing over a square, from the end where the search begins",
        "square": "a square spiral from the centre, for a place that is known well",
        "sector": "three triangles through the centre, for a place that is known very well",
    }
)


@dataclass(frozen=True, slots=True)
class Share:
    """The part of a search that one vehicle flies.

    Attributes:
        tracks: Its legs in order; empty if there are more vehicles than legs.
        items: Its mission.
        altitude: Metres above home.
    """

    tracks: Sequence[Track]
    items: Sequence[MissionItem]
    altitude: float

    @property
    def length(self) -> float:
        """The length of the legs in metres."""
        return sum(track.length for track in self.tracks)

    @property
    def way(self) -> float:
        """The length of the legs and of the straight ways between them, in metres."""
        return self.length + sum(math.dist(one.end, other.start) for one, other in pairwise(self.tracks))


def pattern_tracks(pattern: str, size: float, spacing: float, bearing: float = 0.0) -> list[Track]:
    """Return the legs of a pattern in the order in which one vehicle flies them.

    Args:
        pattern: One of `PATTERNS`.
        size: Side of the square, or the diameter of the sector search, in metres.
        spacing: Metres between tracks; a sector search has none.
        bearing: Direction of the pattern in degrees.

    Returns:
        Legs in metres north and east of the centre.

    Raises:
        InvalidArgumentError: The pattern is unknown, or a number is not finite and positive.
    """
    for name, value in (("size", size), ("spacing", spacing)):
        if not (math.isfinite(value) and value > 0.0):
            raise InvalidArgumentError(f"{name} must be finite and more than 0 m, got {value:g}")
    if pattern in ("parallel", "creeping"):
        along = bearing if pattern == "parallel" else bearing + 90.0
        return order_tracks(cover(_square(size, bearing), spacing, bearing=along))
    if pattern == "square":
        return _path(expanding_square(spacing, max(1, round(2.0 * size / spacing)), bearing=bearing))
    if pattern == "sector":
        return _path(sector(size / 2.0, bearing=bearing))
    raise InvalidArgumentError(f"pattern must be one of {', '.join(PATTERNS)}, got {pattern!r}")


def plan_search(
    tracks: Sequence[Track], searchers: Sequence[Searcher], frame: LocalFrame, options: MissionOptions
) -> list[Share]:
    """Divide the legs of a search among vehicles.

    Args:
        tracks: The legs in order, as `pattern_tracks` or `order_tracks` returns them.
        searchers: The vehicles.
        frame: The frame of the legs.
        options: Heights, speed and pictures; each vehicle is a layer higher than the one before.

    Returns:
        The share of each vehicle, in the order of `searchers`.

    Raises:
        InvalidArgumentError: There is no vehicle.
    """
    return [
        Share(
            share,
            search_mission(share, frame, options, index=index) if share else (),
            options.altitude + index * options.layer_spacing,
        )
        for index, share in enumerate(divide(tracks, searchers))
    ]


def _square(size: float, bearing: float) -> Area:
    angle, half = math.radians(bearing), size / 2.0
    cosine, sine = math.cos(angle) * half, math.sin(angle) * half
    return Area(
        [
            (along * cosine - across * sine, along * sine + across * cosine)
            for along, across in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        ]
    )


def _path(corners: Points) -> list[Track]:
    places = [(float(north), float(east)) for north, east in corners]
    return [Track(start, end, 0) for start, end in pairwise(places)]
