"""Shows: the preview, with the check and where each vehicle is over time, and the flight by setpoints."""

from __future__ import annotations

import asyncio
from math import ceil, isfinite
from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np
from msgspec import Meta

from mavstack.errors import InvalidArgumentError
from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable, WaitField
from mavstack.security.roles import Role
from mavstack.server.api.swarms import STATE
from mavstack.server.api_route import AnyRoute, ApiRoute, Call
from mavstack.server.request_types import Latitude, Longitude
from mavstack.swarm.separation import Margins
from mavstack.swarm.shows.check import RATE, ShowLimits, check_show
from mavstack.swarm.shows.reading import parse_show
from mavstack.swarm.transitions import Limits
from mavstack.vehicle.swarm import Swarm, SwarmOptions

if TYPE_CHECKING:
    from mavstack.swarm.shows.show import Show

#: Maximum size of a show file in bytes.
MAX_BYTES: Final = 16 << 20
#: Maximum number of positions that the check samples, and of positions and times in the answer.
MAX_CHECKED, MAX_PLACES, MAX_TIMES = 3_000_000, 60_000, 1200
#: Positions per second in the answer, unless the limits require fewer.
_PREVIEW_RATE: Final = 5.0


class ShowQuery(Fields):
    """The name and the limits of a show."""

    name: Annotated[str, Meta(description="The name of the file.", max_length=200)] = ""
    position_error: Annotated[
        float,
        Meta(
            description="Standard deviation of positions in metres, for the distance to keep.", ge=0, le=100
        ),
    ] = 0.5
    speed: Annotated[float, Meta(description="Largest speed over ground in m/s.", gt=0, le=1000)] = 5.0
    climb: Annotated[float, Meta(description="Largest vertical speed in m/s.", gt=0, le=1000)] = 2.0
    acceleration: Annotated[float, Meta(description="Largest acceleration in m/s².", gt=0, le=1000)] = 2.0


class ShowFlight(ShowQuery, kw_only=True):
    """Fly a show by setpoints: the part of it in which all vehicles are in the air."""

    wait: WaitField = True
    systems: Annotated[
        str,
        Meta(
            description="System ids of as many vehicles as the show has, in the air, separated by commas.",
            pattern=r"^[1-9][0-9]{0,2}(,[1-9][0-9]{0,2}){0,254}$",
            examples=["1,2,3,4"],
        ),
    ]
    latitude: Annotated[
        Latitude | None,
        Meta(description="Degrees, of the show's origin; null: the middle of the vehicles."),
    ] = None
    longitude: Annotated[Longitude | None, Meta(description="Degrees.")] = None
    orientation: Annotated[
        float, Meta(description="Direction of the show's x axis in degrees, clockwise from north.")
    ] = 0.0

    @property
    def options(self) -> SwarmOptions:
        """How the vehicles fly."""
        limits = Limits(self.speed, self.climb, self.acceleration)
        return SwarmOptions(Margins(position=self.position_error, speed=self.speed), limits)

    @property
    def origin(self) -> tuple[float, float] | None:
        """Latitude and longitude of the show's origin; raises `RefusedError` if one is missing."""
        if self.latitude is None and self.longitude is None:
            return None
        if self.latitude is None or self.longitude is None:
            raise RefusedError(400, "the origin needs both latitude and longitude")
        return self.latitude, self.longitude


ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "swarm")


@ROUTES.add(
    "POST",
    "/api/shows",
    "Check a show, and return where each vehicle is over time; nothing is sent to vehicles",
    role=Role.OPERATE,
    takes_bytes=True,
    max_body=MAX_BYTES,
    answer={
        "name": "circle",
        "duration_s": 60.0,
        "separation_m": 9.4,
        "limit_m": 6.83,
        "speed_m_s": 3.1,
        "climb_m_s": 1.9,
        "acceleration_m_s2": 0.9,
        "problems": [],
        "tracks": [{"name": "vehicle 1", "places": [[0.0, 0.0, 0.0], [0.0, 0.0, 10.0]]}],
    },
)
async def _preview(call: Call[None, ShowQuery]) -> dict[str, Any]:
    return await asyncio.to_thread(preview_show, call.data, call.query)


def preview_show(data: bytes, query: ShowQuery) -> dict[str, Any]:
    """Return the check of a show and its tracks as JSON.

    Args:
        data: The content of the file.
        query: Its name and the limits.

    Raises:
        PlanFileError: It is not a show.
        InvalidArgumentError: It is too long for so many vehicles.
    """
    show = parse_show(data, query.name)
    _check_length(show, "for a preview: use mav swarm show --check")
    distance = Margins(position=query.position_error, speed=query.speed).planned_distance
    report = check_show(show, ShowLimits(distance, Limits(query.speed, query.climb, query.acceleration)))
    return {
        "name": show.name,
        "duration_s": round(report.duration, 3),
        "separation_m": round(report.separation, 2) if isfinite(report.separation) else None,
        "limit_m": round(distance, 2),
        "speed_m_s": round(report.speed, 2),
        "climb_m_s": round(report.climb, 2),
        "acceleration_m_s2": round(report.acceleration, 2),
        "problems": list(report.problems),
        "tracks": _tracks(show),
    }


def _check_length(show: Show, words: str) -> None:
    """Refuse a show whose check would need too much time and memory of the station."""
    if len(show.vehicles) * show.duration * RATE > MAX_CHECKED:
        raise InvalidArgumentError(
            f"a show of {len(show.vehicles)} vehicles and {show.duration:.0f} s is too long {words}"
        )


def _tracks(show: Show) -> list[dict[str, Any]]:
    """Return the places of each vehicle, equally far apart in time from the begin to the end."""
    limit = min(MAX_TIMES, MAX_PLACES // len(show.vehicles))
    count = max(2, min(ceil(show.duration * _PREVIEW_RATE) + 1, limit))
    times = np.linspace(0.0, show.duration, count)
    # Convert the axes forward, left, up of a show to forward, right, up.
    turned = (1.0, -1.0, 1.0)
    return [
        {
            "name": each.name,
            "places": (each.trajectory.positions(times) * turned).round(2).tolist(),
        }
        for each in show.vehicles
    ]


@ROUTES.add(
    "POST",
    "/api/swarm/show",
    "Fly a show by setpoints: the part of it in which all vehicles are in the air",
    role=Role.OPERATE,
    takes_bytes=True,
    max_body=MAX_BYTES,
    answer=STATE,
)
async def _fly(call: Call[None, ShowFlight]) -> dict[str, Any]:
    query, swarm = call.query, call.station.swarm
    origin, systems = query.origin, [int(each) for each in query.systems.split(",")]
    vehicles = swarm.select(systems, None)
    show = await asyncio.to_thread(parse_show, call.data, query.name)
    _check_length(show, "to be flown by the station: use mav swarm show")

    async def work(flying: Swarm) -> None:
        await flying.show(show, origin=origin, orientation=query.orientation)

    return await swarm.fly("show", vehicles, work, query.options)
