"""Messages by name: the latest ones of a vehicle, a stream of them, and messages to send."""

from __future__ import annotations

from typing import Annotated, Any, Final, TypeAlias

from msgspec import Meta
from starlette.responses import Response

from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable
from mavstack.security.roles import Role
from mavstack.server.api.events import EventsQuery, EventStream
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.message_json import latest_json, message_class, message_of
from mavstack.server.message_stream import MessageStream
from mavstack.server.observed_requests import check_request
from mavstack.server.request_types import SendMessage
from mavstack.server.subscriptions import MAX_RATE, Subscriptions

Component: TypeAlias = Annotated[int, Meta(ge=0, le=255)]


class LatestQuery(Fields):
    """The query of the latest message of a name."""

    component: Annotated[
        Component | None, Meta(description="The component id of the sender; null: the one heard last.")
    ] = None


class StreamQuery(EventsQuery):
    """The query of a stream of messages."""

    component: Annotated[Component | None, Meta(description="The component id of the sender; null: any.")] = (
        None
    )
    rate: Annotated[
        Annotated[float, Meta(ge=0.001, le=MAX_RATE)] | None,
        Meta(description="The highest rate, hertz; null: all."),
    ] = None


_EXAMPLE: Final = {
    "message": "ATTITUDE",
    "system": 1,
    "component": 1,
    "time": 1790000000.0,
    "fields": {"time_boot_ms": 8000, "roll": 0.01, "pitch": -0.02, "yaw": 1.57},
    "count": 500,
    "rate": 10.0,
}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "messages")


@ROUTES.add(
    "GET",
    "/api/vehicles/{system}/messages",
    "List the messages that a vehicle sends, with their rates",
    answer=[{"message": "ATTITUDE", "id": 30, "component": 1, "count": 500, "rate": 10.0, "age": 0.05}],
)
async def _list(call: PlainCall) -> list[dict[str, Any]]:
    vehicle, now = call.vehicle, call.station.connection.now()
    found = [
        {
            "message": each.packet.name,
            "id": each.packet.message_id,
            "component": each.packet.component,
            "count": each.count,
            "rate": round(each.rate(now), 3),
            "age": round(now - each.time, 3),
        }
        for each in call.station.packets.latest.of_system(vehicle.system)
    ]
    return sorted(found, key=lambda each: (each["message"] or "", each["id"], each["component"]))


@ROUTES.add(
    "GET", "/api/vehicles/{system}/messages/{name}", "Show the latest message of a name", answer=_EXAMPLE
)
async def _show(call: Call[None, LatestQuery]) -> Response:
    vehicle, connection = call.vehicle, call.station.connection
    kind = message_class(connection.dialect, call.path("name"))
    number = int(kind.__mavlink_row__[0])
    found = call.station.packets.latest.find(vehicle.system, number, call.query.component)
    if found is None:
        raise RefusedError(404, f"{call.path('name')[:60]} of system {vehicle.system} was not received")
    text = latest_json(found, connection.now())
    return Response(text, headers={"Cache-Control": "no-store"}, media_type="application/json")


@ROUTES.add(
    "GET",
    "/api/vehicles/{system}/messages/{name}/stream",
    "Stream the messages of a name by server-sent events, each one as JSON",
    media_type="text/event-stream",
    answer='data: {"message": "ATTITUDE", …}',
)
async def _stream(call: Call[None, StreamQuery]) -> EventStream:
    vehicle, station, query = call.vehicle, call.station, call.query
    number = int(message_class(station.connection.dialect, call.path("name")).__mavlink_row__[0])
    subscriptions = Subscriptions()
    subscriptions.add([number], rate=query.rate, system=vehicle.system, component=query.component)
    lane = station.observer_lane if call.role is Role.OBSERVE else None
    stream = MessageStream(subscriptions, query.count, lane)
    return EventStream(stream.events(station.packets))


@ROUTES.add("POST", "/api/messages", answer={"message": "PING", "system": 255, "component": 190})
async def _send(call: Call[SendMessage, None]) -> dict[str, Any]:
    connection, body = call.station.connection, call.body
    message = message_of(connection.dialect, body.message, body.fields, call.role)
    check_request(call.role, message, call.station)
    connection.send(message)
    return {
        "message": body.message.upper(),
        "system": connection.address.system,
        "component": connection.address.component,
    }
