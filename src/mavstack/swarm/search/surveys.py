"""Surveys: an area or a corridor, covered by tracks and divided into the missions of one vehicle or several.

This is the one planner of surveys: `vehicle.mission`, `connection.group()`, `mav mission survey` and the Plan
view of the station use it. The files in `conformance/survey` hold requests with their plans.

Places are degrees here; the origin of the frame in which a survey is planned is its first place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import InvalidArgumentError
from mavstack.geodesy import LocalFrame
from mavstack.swarm.search.areas import Area, Track, cover
from mavstack.swarm.search.division import divide, order_tracks
from mavstack.swarm.search.grid import divide_by_grid
from mavstack.swarm.search.missions import MissionOptions, search_mission
from mavstack.swarm.search.patterns import offset_line
from mavstack.swarm.search.plans import Share

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mavstack.swarm.search.areas import Corner
    from mavstack.swarm.search.camera import Camera
    from mavstack.swarm.search.division import Searcher

#: A position: latitude and longitude in degrees.
Place = tuple[float, float]
#: The ways to divide a survey between vehicles, with a line about each.
DIVISIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "strips": "consecutive parts of one line of tracks, which end at the same time",
        "grid": "connected regions around the starts of the vehicles",
    }
)
#: Default distance between tracks in metres, if no camera is given.
DEFAULT_SPACING: Final = 20.0
#: Maximum number of corners of an outline or a route.
MAX_CORNERS: Final = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class Survey:
    """How an area is surveyed.

    Attributes:
        spacing: Metres between tracks; None: those of the camera and the side overlap, or `DEFAULT_SPACING`.
        camera: The camera; pictures are taken on the tracks. None: no pictures.
        side_overlap: Part of a picture that the next track shows too.
        front_overlap: Part of a picture that the next one of the track shows too.
        bearing: Direction of the tracks in degrees; None: the one with the fewest tracks.
        crosshatch: True: the area is covered a second time, across the first one.
        turn_radius: Metres that a wing needs for a turn; tracks are interleaved.
        division: One of `DIVISIONS`.
        mission: Heights, speed, and how missions begin and end; its `trigger_distance` is the one of the
            camera if there is one.
    """

    spacing: float | None = None
    camera: Camera | None = None
    side_overlap: float = 0.7
    front_overlap: float = 0.75
    bearing: float | None = None
    crosshatch: bool = False
    turn_radius: float = 0.0
    division: str = "strips"
    mission: MissionOptions = field(default_factory=MissionOptions)

    def __post_init__(self) -> None:
        if self.division not in DIVISIONS:
            raise InvalidArgumentError(
                f"division must be one of {', '.join(DIVISIONS)}, got {self.division!r}"
            )
        for name, value in (("bearing", self.bearing), ("turn_radius", self.turn_radius)):
            if value is not None and not math.isfinite(value):
                raise InvalidArgumentError(f"{name} must be finite, got {value:g}")
        if self.turn_radius < 0.0:
            raise InvalidArgumentError(f"turn_radius must be at least 0 m, got {self.turn_radius:g}")

    @property
    def track_spacing(self) -> float:
        """Metres between tracks."""
        if self.spacing is not None:
            return self.spacing
        if self.camera is None:
            return DEFAULT_SPACING
        return self.camera.spacing(self.mission.altitude, self.side_overlap)

    @property
    def mission_options(self) -> MissionOptions:
        """The options of the missions, with the pictures of the camera."""
        if self.camera is None:
            return self.mission
        distance = self.camera.trigger_distance(self.mission.altitude, self.front_overlap)
        return replace(self.mission, trigger_distance=distance)


@dataclass(frozen=True, slots=True)
class SurveyPlan:
    """A survey that was planned.

    Attributes:
        shares: The share of each vehicle.
        frame: The frame of the legs of the shares.
        spacing: Largest distance between tracks in metres.
        bearing: Direction of the tracks in degrees; None: they follow a route.
        size: The area that is surveyed, in square metres.
    """

    shares: Sequence[Share]
    frame: LocalFrame
    spacing: float
    bearing: float | None
    size: float


def plan_area(
    outline: Sequence[Place],
    searchers: Sequence[Searcher],
    survey: Survey,
    *,
    obstacles: Sequence[Sequence[Place]] = (),
) -> SurveyPlan:
    """Plan the survey of an area.

    Args:
        outline: Corners in degrees, in order.
        searchers: The vehicles; their starts are metres north and east of the first corner.
        survey: How it is surveyed.
        obstacles: Outlines of regions that are left out; the ways between tracks lead around them.

    Raises:
        InvalidArgumentError: The outline, a number, or the number of vehicles is not possible.
    """
    frame = frame_of(outline, minimum=3)
    area = Area(to_metres(frame, outline), [to_metres(frame, each) for each in obstacles])
    bearing = area.best_bearing() if survey.bearing is None else survey.bearing
    spacing = survey.track_spacing
    bearings = (bearing, bearing + 90.0) if survey.crosshatch else (bearing,)
    layers = [cover(area, spacing, bearing=each) for each in bearings]
    if survey.division == "grid":
        tracks = _grid_shares(layers, searchers, survey)
    else:
        ordered: list[Track] = []
        for cells in layers:
            start = ordered[-1].end if ordered else _first_start(searchers)
            ordered += order_tracks(cells, start, turn_radius=survey.turn_radius)
        tracks = divide(ordered, searchers)
    return SurveyPlan(_shares(tracks, frame, survey, area), frame, spacing, bearing, area.size)


def plan_corridor(
    route: Sequence[Place], width: float, searchers: Sequence[Searcher], survey: Survey
) -> SurveyPlan:
    """Plan the survey of a corridor: tracks along a route, side by side.

    Args:
        route: Corners of the middle of the corridor in degrees, in order.
        width: Metres from side to side.
        searchers: The vehicles; their starts are metres north and east of the first corner.
        survey: How it is surveyed; its bearing, crosshatch and division are not used.

    Raises:
        InvalidArgumentError: The route, a number, or the number of vehicles is not possible.
    """
    frame = frame_of(route, minimum=2)
    line = np.array(to_metres(frame, route))
    spacing = survey.track_spacing
    for name, value in (("width", width), ("spacing", spacing)):
        if not (math.isfinite(value) and value > 0.0):
            raise InvalidArgumentError(f"{name} must be finite and more than 0 m, got {value:g}")
    count = max(1, math.ceil(width / spacing - 1e-9))
    if count > MAX_CORNERS:
        raise InvalidArgumentError(f"a corridor has at most {MAX_CORNERS} tracks, {count} are needed")
    tracks: list[Track] = []
    for index in range(count):
        beside = offset_line(line, ((index + 0.5) / count - 0.5) * width).tolist()
        corners = [(north, east) for north, east in (beside if index % 2 == 0 else beside[::-1])]
        tracks += [Track(start, end, index) for start, end in pairwise(corners)]
    length = sum(math.dist(start, end) for start, end in pairwise(line.tolist()))
    shares = _shares(divide(tracks, searchers), frame, survey, None)
    return SurveyPlan(shares, frame, spacing, None, length * width)


def frame_of(places: Sequence[Place], *, minimum: int = 1) -> LocalFrame:
    """Return the frame of a survey, whose origin is its first place.

    Args:
        places: Latitudes and longitudes in degrees.
        minimum: The number of places that are needed.

    Raises:
        InvalidArgumentError: There are fewer places, or more than `MAX_CORNERS`, or one is not on Earth.
    """
    if not minimum <= len(places) <= MAX_CORNERS:
        raise InvalidArgumentError(f"there must be {minimum} to {MAX_CORNERS} corners, got {len(places)}")
    for latitude, longitude in places:
        if not (abs(latitude) <= 90.0 and abs(longitude) <= 180.0):
            raise InvalidArgumentError(f"{latitude:g}, {longitude:g} is not a place on Earth")
    return LocalFrame(*places[0], 0.0)


def to_metres(frame: LocalFrame, places: Sequence[Place]) -> list[Corner]:
    """Return places in degrees as metres north and east of the origin of a frame."""
    local = (frame.to_local(latitude, longitude, 0.0) for latitude, longitude in places)
    return [(north, east) for north, east, _ in local]


def to_degrees(frame: LocalFrame, corner: Corner) -> Place:
    """Return metres north and east of the origin of a frame as a place in degrees."""
    latitude, longitude, _ = frame.to_global(*corner, 0.0)
    return latitude, longitude


def _grid_shares(
    layers: Sequence[Sequence[Sequence[Track]]], searchers: Sequence[Searcher], survey: Survey
) -> list[list[Track]]:
    shares: list[list[Track]] = [[] for _ in searchers]
    for cells in layers:
        for share, own, searcher in zip(
            shares, divide_by_grid(cells, searchers, survey.track_spacing), searchers, strict=True
        ):
            start = share[-1].end if share else searcher.start
            share.extend(order_tracks(own, start, turn_radius=survey.turn_radius))
    return shares


def _first_start(searchers: Sequence[Searcher]) -> Corner | None:
    return next((each.start for each in searchers if each.start is not None), None)


def _shares(
    tracks: Sequence[Sequence[Track]], frame: LocalFrame, survey: Survey, area: Area | None
) -> list[Share]:
    options = survey.mission_options
    return [
        Share(
            share,
            search_mission(share, frame, options, index=index, area=area) if share else (),
            options.altitude + index * options.layer_spacing,
        )
        for index, share in enumerate(tracks)
    ]
