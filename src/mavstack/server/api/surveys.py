"""Plans of surveys and searches, which the planner of `mavstack.swarm.search` makes; nothing is uploaded.

A plan has a share for each vehicle, with the items of its mission as `GET …/mission` returns them, so that a
client shows it, edits it, and uploads it with `PUT /api/vehicles/{system}/mission`.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, TypeAlias

from msgspec import Meta

from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable
from mavstack.server.api_route import AnyRoute, ApiRoute, Call
from mavstack.server.request_types import Latitude, Longitude, Positive
from mavstack.swarm.search.camera import Camera
from mavstack.swarm.search.division import Searcher
from mavstack.swarm.search.missions import MissionOptions
from mavstack.swarm.search.plans import pattern_tracks, plan_search
from mavstack.swarm.search.surveys import (
    MAX_CORNERS,
    Survey,
    frame_of,
    plan_area,
    plan_corridor,
    to_metres,
)
from mavstack.vehicle.swarm.plan_json import share_json, survey_json
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.geodesy import LocalFrame
    from mavstack.server.station import Station

_Place: TypeAlias = tuple[Latitude, Longitude]
_Corners: TypeAlias = Annotated[list[_Place], Meta(max_length=MAX_CORNERS)]
_Part: TypeAlias = Annotated[float, Meta(ge=0, lt=1)]
_AboveZero: TypeAlias = Annotated[float, Meta(gt=0)]
_View: TypeAlias = Annotated[float, Meta(gt=0, lt=180)]
#: Corners of the field in the example, 200 by 100 metres.
_OUTLINE: Final = [[47.3970, 8.5450], [47.3970, 8.5463], [47.3988, 8.5463], [47.3988, 8.5450]]


class SurveyVehicle(Fields):
    """A vehicle that takes a share."""

    system: Annotated[int | None, Meta(description="Its system id; null: it is not known.")] = None
    speed: Annotated[
        _AboveZero | None,
        Meta(
            description="Metres per second along the tracks; null: the ground speed of the plan, or what is "
            "typical of the vehicle's type (15 of planes, 2 of rovers, 5 of copters and unknown vehicles)."
        ),
    ] = None
    endurance: Annotated[float, Meta(description="Time in the air relative to the others.", gt=0)] = 1.0
    start: Annotated[
        _Place | None, Meta(description="Latitude and longitude; null: where the vehicle is, if it is known.")
    ] = None


class SurveyCamera(Fields):
    """A camera that looks straight down."""

    horizontal_view: Annotated[_View, Meta(description="Degrees across the direction of flight.")] = 73.7
    vertical_view: Annotated[_View, Meta(description="Degrees along it.")] = 53.1
    width: Annotated[int, Meta(description="Pixels across; 0: not known.", ge=0)] = 0


class _PlanFields(Fields):
    """The fields of all plans."""

    altitude: Annotated[float, Meta(description="Metres above home of the first vehicle.", gt=0)] = 30.0
    layer_spacing: Annotated[
        Positive, Meta(description="Metres by which each further vehicle is higher.")
    ] = 5.0
    speed: Annotated[
        _AboveZero | None, Meta(description="Ground speed in m/s, which missions set; null: they set none.")
    ] = None
    start_delay: Annotated[
        Positive, Meta(description="Seconds by which each further vehicle starts later.")
    ] = 0.0
    take_off: Annotated[bool, Meta(description="Begin missions with a takeoff.")] = True
    return_home: Annotated[bool, Meta(description="End missions with a return to launch.")] = True
    vehicles: Annotated[
        Annotated[list[SurveyVehicle], Meta(min_length=1, max_length=255)] | None,
        Meta(description="The vehicles; null: one that is not known."),
    ] = None

    def mission(self) -> MissionOptions:
        """Return the options of the missions."""
        return MissionOptions(
            altitude=self.altitude,
            layer_spacing=self.layer_spacing,
            speed=self.speed,
            start_delay=self.start_delay,
            take_off=self.take_off,
            return_home=self.return_home,
        )

    def searchers(self, frame: LocalFrame, station: Station | None = None) -> list[Searcher]:
        """Return the vehicles of the planner; a start that is null is where the station has the vehicle."""
        return [
            Searcher(self._speed(each, station), each.endurance, _start(each, frame, station))
            for each in self.vehicles or [SurveyVehicle()]
        ]

    def speeds(self, searchers: Sequence[Searcher]) -> list[float]:
        """Return the speeds for durations: the one that missions set, or those of the vehicles."""
        return [self.speed or each.speed for each in searchers]

    def _speed(self, each: SurveyVehicle, station: Station | None) -> float:
        known = (
            None if station is None or each.system is None else station.connection.vehicles.get(each.system)
        )
        kind = VehicleType.OTHER if known is None else known.vehicle_type
        return each.speed or self.speed or kind.typical_speed

    def systems(self) -> list[int | None]:
        """Return the system ids of the vehicles."""
        return [each.system for each in self.vehicles or [SurveyVehicle()]]


class PlanSurvey(_PlanFields, kw_only=True):
    """Plan the survey of an area or of a corridor."""

    outline: Annotated[
        _Corners | None,
        Meta(
            description="Corners of the area, latitude and longitude; null: a corridor.",
            examples=[_OUTLINE],
        ),
    ] = None
    obstacles: Annotated[
        Annotated[list[_Corners], Meta(max_length=100)] | None,
        Meta(description="Outlines of regions that are left out."),
    ] = None
    route: Annotated[
        _Corners | None, Meta(description="Corners of the middle of a corridor; null: an area.")
    ] = None
    width: Annotated[float, Meta(description="Metres from side to side of the corridor.", gt=0)] = 100.0
    spacing: Annotated[
        _AboveZero | None,
        Meta(description="Metres between tracks; null: those of the camera, or 20."),
    ] = None
    camera: Annotated[SurveyCamera | None, Meta(description="The camera; null: no pictures.")] = None
    side_overlap: Annotated[_Part, Meta(description="Part of a picture that the next track shows.")] = 0.7
    front_overlap: Annotated[_Part, Meta(description="Part of a picture that the next one shows.")] = 0.75
    bearing: Annotated[
        float | None, Meta(description="Direction of the tracks in degrees; null: the one with the fewest.")
    ] = None
    crosshatch: Annotated[bool, Meta(description="Cover the area a second time, across.")] = False
    turn_radius: Annotated[Positive, Meta(description="Metres that a wing needs for a turn.")] = 0.0
    division: Annotated[
        Literal["strips", "grid"],
        Meta(description="Parts of one line of tracks, or connected regions around the vehicles."),
    ] = "strips"

    def survey(self) -> Survey:
        """Return the options of the planner."""
        camera = self.camera
        return Survey(
            spacing=self.spacing,
            camera=None
            if camera is None
            else Camera(camera.horizontal_view, camera.vertical_view, camera.width),
            side_overlap=self.side_overlap,
            front_overlap=self.front_overlap,
            bearing=self.bearing,
            crosshatch=self.crosshatch,
            turn_radius=self.turn_radius,
            division=self.division,
            mission=self.mission(),
        )


class PlanSearch(_PlanFields, kw_only=True):
    """Plan the search around a point by a pattern."""

    pattern: Annotated[
        Literal["parallel", "creeping", "square", "sector"], Meta(description="The pattern.")
    ] = "parallel"
    center: Annotated[_Place, Meta(description="Latitude and longitude.", examples=[[47.3977, 8.5456]])]
    size: Annotated[
        float, Meta(description="Metres: side of the square, or diameter of a sector search.", gt=0)
    ] = 200.0
    spacing: Annotated[float, Meta(description="Metres between tracks.", gt=0)] = 20.0
    bearing: Annotated[float, Meta(description="Direction of the pattern in degrees.")] = 0.0


def plan_survey(body: PlanSurvey, station: Station | None = None) -> dict[str, Any]:
    """Return the plan of a request as JSON.

    Args:
        body: The request.
        station: The station whose vehicles have positions; None: there is none.

    Raises:
        RefusedError: It has not exactly one of `outline` and `route`.
        InvalidArgumentError: A number or an outline is not possible.
    """
    if (body.outline is None) == (body.route is None):
        raise RefusedError(400, "a survey has an outline or a route, and not both")
    survey, corners = body.survey(), body.outline or body.route or ()
    searchers = body.searchers(frame_of(corners), station)
    if body.outline is not None:
        plan = plan_area(body.outline, searchers, survey, obstacles=body.obstacles or ())
    else:
        plan = plan_corridor(corners, body.width, searchers, survey)
    return survey_json(plan, survey, body.systems(), body.speeds(searchers))


def plan_pattern(body: PlanSearch, station: Station | None = None) -> dict[str, Any]:
    """Return the plan of a search as JSON.

    Args:
        body: The request.
        station: The station whose vehicles have positions; None: there is none.

    Raises:
        InvalidArgumentError: A number is not possible.
    """
    frame = frame_of([body.center])
    tracks = pattern_tracks(body.pattern, body.size, body.spacing, body.bearing)
    searchers = body.searchers(frame, station)
    shares = plan_search(tracks, searchers, frame, body.mission())
    return {
        "spacing_m": body.spacing,
        "shares": [
            share_json(share, frame, system, speed)
            for share, system, speed in zip(shares, body.systems(), body.speeds(searchers), strict=True)
        ],
    }


def _start(each: SurveyVehicle, frame: LocalFrame, station: Station | None) -> tuple[float, float] | None:
    place = each.start
    if place is None and station is not None and each.system is not None:
        vehicle = station.connection.vehicles.get(each.system)
        position = None if vehicle is None else vehicle.position
        place = None if position is None else (position.latitude, position.longitude)
    return None if place is None else to_metres(frame, [place])[0]


_ITEM: Final = {
    "seq": 0,
    "command": 22,
    "name": "NAV_TAKEOFF",
    "frame": 6,
    "params": [0, 0, 0, None, 0, 0, 30],
    "autocontinue": True,
}
_SHARE: Final = {
    "system": 1,
    "altitude_m": 30.0,
    "length_m": 1000.0,
    "way_m": 1080.0,
    "speed_m_s": 5.0,
    "duration_s": 216.0,
    "legs": [[[47.3970, 8.5450], [47.3988, 8.5450]]],
    "items": [_ITEM],
}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "plans")


@ROUTES.add(
    "POST",
    "/api/surveys",
    answer={
        "spacing_m": 20.0,
        "bearing_deg": 0.0,
        "area_m2": 20000.0,
        "footprint_m": None,
        "trigger_distance_m": 0.0,
        "pixel_m": None,
        "shares": [_SHARE],
    },
)
async def _survey(call: Call[PlanSurvey, None]) -> dict[str, Any]:
    return await asyncio.to_thread(plan_survey, call.body, call.station)


@ROUTES.add("POST", "/api/searches", answer={"spacing_m": 20.0, "shares": [_SHARE]})
async def _search(call: Call[PlanSearch, None]) -> dict[str, Any]:
    return await asyncio.to_thread(plan_pattern, call.body, call.station)
