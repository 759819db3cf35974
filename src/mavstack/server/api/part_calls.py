"""The calls of services that have no routes of their own, by the table of the parts of a component."""

from __future__ import annotations

from typing import Annotated, Any, Final

from msgspec import Meta

from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable
from mavstack.node import RemoteComponent
from mavstack.node.part_calls import find_call, offered_calls
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.json_values import to_json

_PATH: Final = "/api/vehicles/{system}/calls"


class CallPart(Fields):
    """The arguments of a call."""

    arguments: Annotated[
        dict[str, bool | float | int | str],
        Meta(
            description="The arguments by their names.",
            examples=[{"latitude": 47.3977, "longitude": 8.5456}],
        ),
    ]


ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "vehicles")


@ROUTES.add(
    "GET",
    _PATH,
    "List the calls of services that have no routes of their own",
    answer=[
        {
            "part": "terrain",
            "call": "check",
            "summary": "Ask for the terrain that the vehicle has at a position.",
            "arguments": {"latitude": "float", "longitude": "float"},
            "required": ["latitude", "longitude"],
        }
    ],
)
async def _list(call: PlainCall) -> list[dict[str, Any]]:
    component = type(call.vehicle.component)  # raises the refusal if the vehicle is unknown
    return [
        {
            "part": each.part.name,
            "call": each.name,
            "summary": each.summary,
            "arguments": {name: kind.__name__ for name, kind in each.arguments.items()},
            "required": list(each.required),
        }
        for each in offered_calls(component)
    ]


@ROUTES.add(
    "POST",
    f"{_PATH}/{{part}}/{{call}}",
    "Call a service that has no routes of its own",
    role=Role.OPERATE,
    answer={"result": {"spacing": 100, "terrain_height": 488.0}},
)
async def _run(call: Call[CallPart, None]) -> dict[str, Any]:
    found = find_call(RemoteComponent, call.path("part"), call.path("call"))
    if found is None:
        raise RefusedError(404, f"there is no call {call.path('part')}/{call.path('call')}")
    return {"result": to_json(await found.run(call.vehicle.component, call.body.arguments))}
