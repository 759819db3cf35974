"""The subprotocol `mavstack.raw.1`: raw MAVLink packets over a WebSocket, in both directions.

Each binary message holds one or more complete packets. The server sends every packet that the station
receives, and passes the client's packets to the vehicles unchanged, as far as the client's role allows: a
browser is a MAVLink component of its own, with ids that `sender_rules` allows. SETUP_SIGNING is passed in no
direction.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.security.roles import Role, RoleFilter
from mavstack.server.client_queue import ClientQueue
from mavstack.server.sender_rules import SenderRules
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from starlette.websockets import WebSocket

    from mavstack.server.packet_hub import Batch
    from mavstack.server.station import Station
    from mavstack.wire import Packet

SUBPROTOCOL: Final = "mavstack.raw.1"
#: Bytes that wait for a client.
MAX_QUEUE: Final = 1 << 20


class RawClient:
    """One client."""

    def __init__(self, station: Station, websocket: WebSocket, role: Role) -> None:
        self.queue: ClientQueue[bytes] = ClientQueue(MAX_QUEUE)
        self._connection = station.connection
        self._websocket = websocket
        self._rules = SenderRules(station.connection, role)
        # One parser decides where packets begin: a second one could find others in what the first allowed.
        self._packets: Callable[[bytes], Iterable[Packet]] = (
            Parser(station.connection.dialect).feed if role is Role.ADMINISTER else RoleFilter(role).packets
        )

    def put(self, batch: Batch) -> None:
        """Queue the bytes of a batch."""
        self.queue.put(batch.data, len(batch.packets))

    async def send(self) -> None:
        """Send what is queued, until the task is cancelled."""
        async for data in self.queue.stream():
            await self._websocket.send_bytes(data)

    async def receive(self, data: str | bytes) -> None:
        """Pass the packets of a message to the vehicles; a text is ignored."""
        if isinstance(data, str):
            return
        for packet in self._packets(data):
            if self._rules.allow(packet):
                self._connection.forward(packet)
