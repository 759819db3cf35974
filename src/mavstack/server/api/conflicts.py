"""Several vehicles with one system id: the choice between them, another system id, and events."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Any, Final, TypeAlias

from msgspec import Meta

from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable, Wait
from mavstack.security.roles import Role
from mavstack.server.api.events import EventsQuery, EventStream
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.conflict_json import conflict_json
from mavstack.server.request_types import Text, Timeout
from mavstack.services.identity import ALL_IDENTITY_PARAMETERS
from mavstack.vehicle import VehicleEvent

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

_SYSTEM: Final = "/api/vehicles/{system}"
_EVENT_QUEUE: Final = 64
Channel: TypeAlias = Annotated[
    Text | None,
    Meta(
        description="The channel of a sender, or its remote address; null: take the choice back.",
        examples=["udpin 127.0.0.1:40001"],
    ),
]


class ChooseSender(Fields):
    """Choose one of several vehicles with one system id by its channel."""

    channel: Channel = None


class Renumber(Fields):
    """Give a vehicle another system id, and reboot it if that is needed."""

    channel: Channel = None
    id: Annotated[
        Annotated[int, Meta(ge=1, le=255)] | None,
        Meta(description="The new system id; null: a free one.", examples=[2]),
    ] = None
    timeout: Timeout = None


ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "vehicles")


@ROUTES.add("POST", f"{_SYSTEM}/sender", role=Role.OPERATE, answer={"system": 1, "conflict": None})
async def _choose(call: Call[ChooseSender, None]) -> dict[str, Any]:
    vehicle = call.vehicle
    vehicle.choose_sender(call.body.channel)
    return {"system": vehicle.system, "conflict": conflict_json(vehicle)}


@ROUTES.add(
    "POST",
    f"{_SYSTEM}/renumber",
    role=Role.ADMINISTER,
    answer={"system": 1, "id": 2, "parameter": "SYSID_THISMAV", "rebooted": True},
)
async def _renumber(call: Call[Renumber, Wait]) -> dict[str, Any]:
    vehicle, body = call.vehicle, call.body
    if body.channel is not None:
        vehicle.choose_sender(body.channel)
    done = await vehicle.renumber(body.id, timeout=body.timeout)
    return {
        "system": vehicle.system,
        "id": done.system,
        "parameter": done.parameter,
        "rebooted": done.rebooted,
    }


@ROUTES.add(
    "GET",
    "/api/identity-parameters",
    "List the parameters that identify a vehicle; no file should set them",
    tag="parameters",
    answer={"names": list(ALL_IDENTITY_PARAMETERS)},
)
async def _identity(_call: PlainCall) -> dict[str, Any]:
    return {"names": list(ALL_IDENTITY_PARAMETERS)}


@ROUTES.add(
    "GET",
    "/api/events",
    "Follow the events of the vehicles, such as found, lost, rebooted, system id conflict",
    media_type="text/event-stream",
    answer='data: {"type": "VehicleLost", "system": 1, "time": 1.0, "text": "…", "conflict": null}\n\n',
)
async def _events(call: Call[None, EventsQuery]) -> EventStream:
    return EventStream(_event_lines(call))


async def _event_lines(call: Call[None, EventsQuery]) -> AsyncIterator[str]:
    connection, count = call.station.connection, call.query.count
    async with connection.events(VehicleEvent, queue=_EVENT_QUEUE) as events:
        sent = 0
        async for event in events:
            values = {
                "type": type(event).__name__,
                "system": event.vehicle.system,
                "time": connection.now(),
                "text": str(event),
                "conflict": conflict_json(event.vehicle),
            }
            yield f"data: {json.dumps(values)}\n\n"
            sent += 1
            if sent == count:
                return
