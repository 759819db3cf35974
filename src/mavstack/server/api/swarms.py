"""The swarm of the station: formations, moves, landing, and its state with the smallest separation.

A call is answered when all members have arrived, or with `wait=false` at once with the id of a task. Metres
between vehicles are those of the guard: heights are divided by two.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from msgspec import Meta

from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable, Wait
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.request_types import Latitude, Longitude, Positive
from mavstack.swarm.formations import FORMATIONS, Formation, default_spacing
from mavstack.vehicle.swarm import Swarm, SwarmOptions
from mavstack.vehicle.swarm.launch import DEFAULT_ALTITUDE, take_off

if TYPE_CHECKING:
    from mavstack.vehicle.group import Group

_Shape = Literal[
    "line", "column", "wedge", "echelon", "diamond", "grid", "circle", "sphere", "text", "points"
]
_AboveZero = Annotated[float, Meta(gt=0)]
#: Maximum number of vehicles in a preview.
_MAX_SLOTS: Final = 255


class Members(Fields):
    """The vehicles of a call."""

    systems: Annotated[
        Annotated[list[int], Meta(min_length=1, max_length=255)] | None,
        Meta(description="System ids; null: the members of the swarm, or all vehicles that are alive."),
    ] = None
    lead: Annotated[
        int | None, Meta(description="System id of the leader; null: the present one, or the lowest.")
    ] = None


class _Shaped(Members):
    """The fields of a formation."""

    shape: Annotated[_Shape, Meta(description="The shape.")] = "wedge"
    spacing: Annotated[
        _AboveZero | None,
        Meta(description="Metres between neighbours; null: the one that any exchange of slots needs."),
    ] = None
    angle: Annotated[float, Meta(description="Degrees between the course and the arms.", gt=0, le=90)] = 45.0
    rotation: Annotated[float, Meta(description="Degrees by which the whole formation is turned.")] = 0.0
    layers: Annotated[int, Meta(description="The number of height layers.", ge=1, le=20)] = 1
    layer_spacing: Annotated[Positive, Meta(description="Metres between height layers.")] = 0.0
    text: Annotated[str, Meta(description="The text of the shape text.", max_length=20)] = ""
    points: Annotated[
        Annotated[list[tuple[float, float, float]], Meta(max_length=_MAX_SLOTS)] | None,
        Meta(description="Metres forward, right and up of the leader, for the shape points."),
    ] = None

    def formation(self) -> Formation:
        """Return the formation."""
        spacing = self.spacing
        if spacing is None:
            spacing = default_spacing(self.shape, SwarmOptions().margins.planned_distance)
        return Formation(
            self.shape,
            spacing=spacing,
            angle=self.angle,
            rotation=self.rotation,
            layers=self.layers,
            layer_spacing=self.layer_spacing,
            text=self.text,
            points=self.points or (),
        )


class PreviewFormation(_Shaped):
    """Compute the slots of a formation; nothing is sent to vehicles."""

    count: Annotated[int, Meta(description="The number of vehicles.", ge=1, le=_MAX_SLOTS)] = 5


class FlyFormation(_Shaped):
    """Fly into a formation around the leader."""

    course: Annotated[
        float | None, Meta(description="Direction of the formation in degrees; null: the present one.")
    ] = None
    altitude: Annotated[
        _AboveZero | None, Meta(description="Metres of the leader above its home; null: its height.")
    ] = None
    takeoff: Annotated[
        bool, Meta(description="Arm the vehicles that are on the ground, and let them take off first.")
    ] = False


class LaunchSwarm(Members):
    """Arm vehicles, and let them take off to one height or to layers."""

    altitude: Annotated[float, Meta(description="Metres above home.", gt=0)] = DEFAULT_ALTITUDE
    layer_spacing: Annotated[
        Positive, Meta(description="Metres by which each vehicle is higher than the one before.")
    ] = 0.0


class MoveSwarm(Members):
    """Move all members by the same way."""

    north: Annotated[float, Meta(description="Metres.")] = 0.0
    east: Annotated[float, Meta(description="Metres.")] = 0.0
    up: Annotated[float, Meta(description="Metres.")] = 0.0


class SendSwarm(Members, kw_only=True):
    """Move all members so that the leader arrives at a place."""

    latitude: Latitude
    longitude: Longitude
    altitude: Annotated[
        _AboveZero | None, Meta(description="Metres above the leader's home; null: its height.")
    ] = None


class RotateSwarm(Members):
    """Turn the formation around its leader."""

    degrees: Annotated[float, Meta(description="Clockwise if positive.")] = 90.0


class FollowVehicle(_Shaped, kw_only=True):
    """Follow a vehicle that is not a member."""

    leader: Annotated[
        int, Meta(description="System id of the vehicle to follow.", ge=1, le=255, examples=[9])
    ]
    seconds: Annotated[
        _AboveZero | None, Meta(description="End after this time; null: until it is stopped.")
    ] = None


#: The answer of operations that return the state of the swarm.
STATE: Final = {
    "active": True,
    "action": "formation",
    "reason": None,
    "paused": False,
    "leader": 1,
    "systems": [1],
    "course_deg": 0.0,
    "separation_m": 9.8,
    "nearest_pair": [1, 2],
    "smallest_separation_m": 7.1,
    "limit_m": 2.0,
    "members": [
        {
            "system": 1,
            "follows": True,
            "alive": True,
            "armed": True,
            "mode": "GUIDED",
            "latitude": 47.398,
            "longitude": 8.546,
            "altitude_m": 20.0,
        }
    ],
}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "swarm")


@ROUTES.add("GET", "/api/swarm", "Show the swarm, with the smallest separation of its members", answer=STATE)
async def _show(call: PlainCall) -> dict[str, Any]:
    return call.station.swarm.values()


@ROUTES.add(
    "GET",
    "/api/swarm/formations",
    "List the formations",
    answer={"line": "abeam of the leader, alternately right and left"},
)
async def _list(call: PlainCall) -> dict[str, str]:
    return dict(FORMATIONS)


@ROUTES.add(
    "POST",
    "/api/swarm/preview",
    answer={"shape": "wedge", "spacing_m": 10.0, "slots": [[0.0, 0.0, 0.0], [-7.071, 7.071, 0.0]]},
)
async def _preview(call: Call[PreviewFormation, None]) -> dict[str, Any]:
    shape = call.body.formation()
    slots = shape.offsets(call.body.count)
    return {"shape": shape.name, "spacing_m": shape.spacing, "slots": slots.round(3).tolist()}


@ROUTES.add("POST", "/api/swarm/formation", role=Role.OPERATE, answer=STATE)
async def _formation(call: Call[FlyFormation, Wait]) -> dict[str, Any]:
    body, swarm = call.body, call.station.swarm
    shape, vehicles = body.formation(), swarm.select(body.systems, body.lead)

    if body.takeoff:
        altitude = DEFAULT_ALTITUDE if body.altitude is None else body.altitude
        await swarm.take_off(vehicles, lambda group: _launch(group, altitude, 0.0))

    async def work(flying: Swarm) -> None:
        await flying.formation(shape, course=body.course, altitude=body.altitude)

    return await swarm.fly("formation", vehicles, work)


@ROUTES.add("POST", "/api/swarm/takeoff", role=Role.OPERATE, answer=STATE)
async def _takeoff(call: Call[LaunchSwarm, Wait]) -> dict[str, Any]:
    body, swarm = call.body, call.station.swarm
    vehicles = swarm.select(body.systems, body.lead)
    return await swarm.take_off(vehicles, lambda group: _launch(group, body.altitude, body.layer_spacing))


async def _launch(group: Group, altitude: float, layer_spacing: float) -> None:
    (await take_off(group, altitude, layer_spacing=layer_spacing)).check()


@ROUTES.add("POST", "/api/swarm/move", role=Role.OPERATE, answer=STATE)
async def _move(call: Call[MoveSwarm, Wait]) -> dict[str, Any]:
    body = call.body
    return await _fly(call, "move", lambda swarm: swarm.move(body.north, body.east, body.up))


@ROUTES.add("POST", "/api/swarm/goto", role=Role.OPERATE, answer=STATE)
async def _goto(call: Call[SendSwarm, Wait]) -> dict[str, Any]:
    body = call.body
    return await _fly(call, "goto", lambda swarm: swarm.goto(body.latitude, body.longitude, body.altitude))


@ROUTES.add("POST", "/api/swarm/rotate", role=Role.OPERATE, answer=STATE)
async def _rotate(call: Call[RotateSwarm, Wait]) -> dict[str, Any]:
    degrees = call.body.degrees
    return await _fly(call, "rotate", lambda swarm: swarm.rotate(degrees))


@ROUTES.add("POST", "/api/swarm/follow", role=Role.OPERATE, answer=STATE)
async def _follow(call: Call[FollowVehicle, Wait]) -> dict[str, Any]:
    body, station = call.body, call.station
    leader, shape = station.vehicle(body.leader), body.formation()
    vehicles = [each for each in station.swarm.select(body.systems, body.lead) if each is not leader]
    if not vehicles:
        raise RefusedError(409, "no other vehicle than the leader is alive")

    async def work(flying: Swarm) -> None:
        await flying.follow(leader, shape, duration=body.seconds)

    return await station.swarm.fly("follow", vehicles, work)


async def _fly(call: Call[Any, Any], action: str, work: Any) -> dict[str, Any]:  # noqa: ANN401 (a function)
    swarm = call.station.swarm
    return await swarm.fly(action, swarm.select(call.body.systems, call.body.lead), work)


@ROUTES.add("POST", "/api/swarm/land", "Land all members", role=Role.OPERATE, answer=STATE)
async def _land(call: Call[Members, Wait]) -> dict[str, Any]:
    swarm = call.station.swarm
    return await swarm.land(swarm.select(call.body.systems, call.body.lead))


@ROUTES.add("POST", "/api/swarm/stop", "Stop all members", role=Role.OPERATE, answer=STATE)
async def _stop(call: Call[Members, None]) -> dict[str, Any]:
    swarm = call.station.swarm
    return await swarm.stop(swarm.select(call.body.systems, call.body.lead))


@ROUTES.add(
    "POST",
    "/api/swarm/pause",
    "Let all members stop on their ways, and wait; the flight does not end",
    role=Role.OPERATE,
    answer=STATE,
)
async def _pause(call: PlainCall) -> dict[str, Any]:
    return call.station.swarm.pause(paused=True)


@ROUTES.add(
    "POST", "/api/swarm/resume", "Continue the flight that was paused", role=Role.OPERATE, answer=STATE
)
async def _resume(call: PlainCall) -> dict[str, Any]:
    return call.station.swarm.pause(paused=False)


@ROUTES.add(
    "DELETE", "/api/swarm", "End the swarm: each member holds where it is", role=Role.OPERATE, answer=STATE
)
async def _end(call: PlainCall) -> dict[str, Any]:
    swarm = call.station.swarm
    await swarm.close()
    return swarm.values()
