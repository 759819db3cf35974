"""The subprotocol `mavstack.json.1`: messages as JSON over a WebSocket.

Requests of the client, each one JSON object in a text message:

    {"subscribe": ["ATTITUDE", "GPS_RAW_INT"], "rate": 10, "system": 1, "component": null}
    {"unsubscribe": ["ATTITUDE"]}
    {"send": {"message": "PING", "fields": {"seq": 1}}}

`"*"` stands for all messages. `rate` is the highest rate of each message from each component, in hertz; null:
all of them. The server sends one object per message (`mavstack.server.message_json`), `{"error": …}` after a
request that it refuses, and `{"dropped": N}` when the client was too slow.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Any, Final, TypeAlias

from msgspec import Meta

from mavstack.errors import MavstackError
from mavstack.http.bodies import RefusedError, parse_json
from mavstack.http.immediate_writes import immediate_writer
from mavstack.http.request_fields import Fields, read_fields
from mavstack.security.roles import Role
from mavstack.server.client_queue import ClientQueue, stream_texts
from mavstack.server.message_json import message_class, message_of
from mavstack.server.observed_requests import check_request
from mavstack.server.problems import problem_json
from mavstack.server.request_types import SendMessage
from mavstack.server.subscriptions import ALL, MAX_RATE, Subscriptions

if TYPE_CHECKING:
    from collections.abc import Iterable

    from starlette.websockets import WebSocket

    from mavstack.server.packet_hub import Batch
    from mavstack.server.station import Station

SUBPROTOCOL: Final = "mavstack.json.1"
#: Maximum number of characters in the send queue of a client.
MAX_QUEUE: Final = 2 << 20
MAX_NAMES: Final = 512
Names: TypeAlias = Annotated[
    tuple[str, ...], Meta(max_length=MAX_NAMES, description="The names of messages.")
]
SystemId: TypeAlias = Annotated[
    Annotated[int, Meta(ge=0, le=255)] | None, Meta(description="The sender; null: any.")
]


class Subscribe(Fields):
    """The request of messages by their names."""

    subscribe: Names
    rate: Annotated[
        Annotated[float, Meta(ge=0.001, le=MAX_RATE)] | None,
        Meta(description="The highest rate in hertz; null: all."),
    ] = None
    system: SystemId = None
    component: SystemId = None


class Unsubscribe(Fields):
    """The end of a request of messages."""

    unsubscribe: Names


class Send(Fields):
    """A message to send."""

    send: Annotated[dict[str, Any], Meta(description="A message.")]


class JsonClient:
    """One client."""

    def __init__(self, station: Station, websocket: WebSocket, role: Role) -> None:
        write_now = None if role is Role.OBSERVE else immediate_writer(websocket)
        self.queue: ClientQueue[str] = ClientQueue(MAX_QUEUE, write_now)
        self._station = station
        self._connection = station.connection
        self._websocket = websocket
        self._role = role
        self._subscriptions = Subscriptions()

    def put(self, batch: Batch) -> None:
        """Send or queue the messages of a batch that the client wants."""
        wants = self._subscriptions.wants
        wanted = [index for index, (packet, time) in enumerate(batch.packets) if wants(packet, time)]
        self.queue.put_all([batch.text(index) for index in wanted])

    async def send(self) -> None:
        """Send what is queued, until the task is cancelled."""
        async for text in stream_texts(self.queue):
            if self._role is Role.OBSERVE:
                await self._station.observer_lane.turn()
            await self._websocket.send_text(text)

    async def receive(self, data: str | bytes) -> None:
        """Carry out a request."""
        try:
            self._handle(parse_json(data))
        except (RefusedError, MavstackError) as error:
            self.queue.put(json.dumps(problem_json(error)), 0)

    def _handle(self, request: object) -> None:
        values = request if isinstance(request, dict) else {}
        if "subscribe" in values:
            wanted = read_fields(Subscribe, values)
            ids = self._ids(wanted.subscribe)
            self._subscriptions.add(ids, rate=wanted.rate, system=wanted.system, component=wanted.component)
        elif "unsubscribe" in values:
            self._subscriptions.remove(self._ids(read_fields(Unsubscribe, values).unsubscribe))
        elif "send" in values:
            sent = read_fields(SendMessage, read_fields(Send, values).send)
            message = message_of(self._connection.dialect, sent.message, sent.fields, self._role)
            check_request(self._role, message, self._station)
            self._connection.send(message)
        else:
            raise RefusedError(400, "a request is a JSON object with subscribe, unsubscribe or send")

    def _ids(self, names: Iterable[str]) -> list[int]:
        dialect = self._connection.dialect
        return [
            ALL if name == "*" else int(message_class(dialect, name).__mavlink_row__[0]) for name in names
        ]
