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
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import MavstackError
from mavstack.http.bodies import RefusedError, parse_json
from mavstack.security.roles import Role
from mavstack.server.client_queue import ClientQueue, stream_texts
from mavstack.server.fields import Field, read_fields
from mavstack.server.message_json import message_class, message_of
from mavstack.server.observed_requests import check_request
from mavstack.server.problems import problem_json
from mavstack.server.subscriptions import ALL, MAX_RATE, Subscriptions

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

    from mavstack.server.packet_hub import Batch
    from mavstack.server.station import Station

SUBPROTOCOL: Final = "mavstack.json.1"
#: Characters that wait for a client.
MAX_QUEUE: Final = 2 << 20
MAX_NAMES: Final = 512
_SUBSCRIBE: Final = (
    Field(name="subscribe", type="array", about="The names of messages.", required=True),
    Field(name="rate", about="The highest rate in hertz; null: all.", minimum=0.001, maximum=MAX_RATE),
    Field(name="system", type="integer", about="The sender; null: any.", minimum=0, maximum=255),
    Field(name="component", type="integer", about="The sender; null: any.", minimum=0, maximum=255),
)
_UNSUBSCRIBE: Final = (
    Field(name="unsubscribe", type="array", about="The names of messages.", required=True),
)
_SEND: Final = (Field(name="send", type="object", about="A message.", required=True),)
_MESSAGE: Final = (
    Field(name="message", type="string", about="The name of the message.", required=True),
    Field(name="fields", type="object", about="The fields by name.", default={}),
)


class JsonClient:
    """One client."""

    def __init__(self, station: Station, websocket: WebSocket, role: Role) -> None:
        self.queue: ClientQueue[str] = ClientQueue(MAX_QUEUE)
        self._station = station
        self._connection = station.connection
        self._websocket = websocket
        self._role = role
        self._subscriptions = Subscriptions()

    def put(self, batch: Batch) -> None:
        """Queue the messages of a batch that the client wants."""
        for index, (packet, time) in enumerate(batch.packets):
            if self._subscriptions.wants(packet, time):
                self.queue.put(batch.text(index))

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
            self._subscribe(read_fields(_SUBSCRIBE, values))
        elif "unsubscribe" in values:
            self._subscriptions.remove(self._ids(read_fields(_UNSUBSCRIBE, values)["unsubscribe"]))
        elif "send" in values:
            sent = read_fields(_MESSAGE, read_fields(_SEND, values)["send"])
            dialect = self._connection.dialect
            message = message_of(dialect, sent["message"], sent["fields"], self._role)
            check_request(self._role, message, self._station)
            self._connection.send(message)
        else:
            raise RefusedError(400, "a request is a JSON object with subscribe, unsubscribe or send")

    def _subscribe(self, values: dict[str, Any]) -> None:
        ids = self._ids(values.pop("subscribe"))
        self._subscriptions.add(ids, **values)

    def _ids(self, names: list[Any]) -> list[int]:
        if len(names) > MAX_NAMES or not all(isinstance(name, str) for name in names):
            raise RefusedError(400, f"names of messages are at most {MAX_NAMES} texts")
        dialect = self._connection.dialect
        return [
            ALL if name == "*" else int(message_class(dialect, name).__mavlink_row__[0]) for name in names
        ]
