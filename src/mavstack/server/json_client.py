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
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from mavstack.errors import MavstackError
from mavstack.http.bodies import RefusedError, parse_json
from mavstack.server.client_queue import ClientQueue, stream_texts
from mavstack.server.fields import Field, read_fields
from mavstack.server.message_json import message_class, message_of
from mavstack.server.problems import problem_json

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

    from mavstack.security.roles import Role
    from mavstack.server.packet_hub import Batch
    from mavstack.server.station import Station

SUBPROTOCOL: Final = "mavstack.json.1"
#: Characters that wait for a client.
MAX_QUEUE: Final = 2 << 20
MAX_RATE: Final = 1000.0
MAX_NAMES: Final = 512
#: Messages of components whose next time is kept, for clients with a rate.
MAX_TIMES: Final = 8192
_ALL: Final = -1
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


class _Wanted(NamedTuple):
    """A subscription: the shortest interval in seconds, and the sender."""

    interval: float
    system: int | None
    component: int | None


class JsonClient:
    """One client."""

    def __init__(self, station: Station, websocket: WebSocket, role: Role) -> None:
        self.queue: ClientQueue[str] = ClientQueue(MAX_QUEUE)
        self._connection = station.connection
        self._websocket = websocket
        self._role = role
        self._wanted: dict[int, _Wanted] = {}
        self._next_times: dict[tuple[int, int, int], float] = {}

    def put(self, batch: Batch) -> None:
        """Queue the messages of a batch that the client wants."""
        if not self._wanted:
            return
        for index, (packet, time) in enumerate(batch.packets):
            wanted = self._wanted.get(packet.message_id) or self._wanted.get(_ALL)
            if wanted is None:
                continue
            if wanted.system not in (None, packet.system) or wanted.component not in (None, packet.component):
                continue
            key = (packet.system, packet.component, packet.message_id)
            if wanted.interval and not self._is_due(key, time, wanted.interval):
                continue
            self.queue.put(batch.text(index))

    async def send(self) -> None:
        """Send what is queued, until the task is cancelled."""
        async for text in stream_texts(self.queue):
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
            for number in self._numbers(read_fields(_UNSUBSCRIBE, values)["unsubscribe"]):
                self._wanted.pop(number, None)
        elif "send" in values:
            sent = read_fields(_MESSAGE, read_fields(_SEND, values)["send"])
            dialect = self._connection.dialect
            self._connection.send(message_of(dialect, sent["message"], sent["fields"], self._role))
        else:
            raise RefusedError(400, "a request is a JSON object with subscribe, unsubscribe or send")

    def _subscribe(self, values: dict[str, Any]) -> None:
        interval = 0.0 if values["rate"] is None else 1.0 / values["rate"]
        wanted = _Wanted(interval, values["system"], values["component"])
        self._wanted |= dict.fromkeys(self._numbers(values["subscribe"]), wanted)

    def _numbers(self, names: list[Any]) -> list[int]:
        if len(names) > MAX_NAMES or not all(isinstance(name, str) for name in names):
            raise RefusedError(400, f"names of messages are at most {MAX_NAMES} texts")
        dialect = self._connection.dialect
        return [
            _ALL if name == "*" else int(message_class(dialect, name).__mavlink_row__[0]) for name in names
        ]

    def _is_due(self, key: tuple[int, int, int], time: float, interval: float) -> bool:
        due = self._next_times.get(key, time)
        if time < due - interval * 0.05:  # the interval of the sender varies a little
            return False
        if len(self._next_times) >= MAX_TIMES:
            self._next_times.clear()
        self._next_times[key] = max(due + interval, time)
        return True
