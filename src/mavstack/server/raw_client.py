"""The subprotocol `mavstack.raw.1`: raw MAVLink packets over a WebSocket, in both directions.

Each binary message holds one or more complete packets. The server sends every packet that the station
receives, and passes the client's packets to the vehicles unchanged, as far as the client's role allows: a
browser is a MAVLink component of its own, with ids that `sender_rules` allows. SETUP_SIGNING is passed in no
direction.
"""

from __future__ import annotations

import asyncio
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.http.immediate_writes import immediate_writer
from mavstack.security.roles import Role, RoleFilter
from mavstack.server.client_queue import ClientQueue
from mavstack.server.sender_rules import SenderRules
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from starlette.websockets import WebSocket

    from mavstack.server.packet_hub import Batch
    from mavstack.server.station import Station
    from mavstack.wire import Packet

SUBPROTOCOL: Final = "mavstack.raw.1"
#: Maximum number of bytes in the send queue of a client.
MAX_QUEUE: Final = 1 << 20
#: Bytes of a client that are handled at a time, and per second, so that other clients are served too.
SLICE: Final = 4096
RATES: Final[Mapping[Role, float]] = MappingProxyType(
    {Role.OBSERVE: 16_000.0, Role.OPERATE: 500_000.0, Role.ADMINISTER: 10_000_000.0}
)
#: The number of possible message ids (24 bits).
_IDS: Final = 1 << 24


class RawClient:
    """One client."""

    def __init__(self, station: Station, websocket: WebSocket, role: Role) -> None:
        write_now = None if role is Role.OBSERVE else immediate_writer(websocket)
        self.queue: ClientQueue[bytes] = ClientQueue(MAX_QUEUE, write_now)
        self._connection = station.connection
        self._station = station
        self._role = role
        self._websocket = websocket
        self._rules = SenderRules(station.connection, role)
        # Only one parser looks for packets: a second one could find other packets in the allowed bytes.
        self._packets: Callable[[bytes], Iterable[Packet]] = (
            Parser(station.connection.dialect).feed if role is Role.ADMINISTER else RoleFilter(role).packets
        )

    def put(self, batch: Batch) -> None:
        """Send or queue the bytes of a batch."""
        self.queue.put(batch.data, len(batch.packets))

    async def send(self) -> None:
        """Send what is queued, until the task is cancelled."""
        async for data in self.queue.stream():
            if self._role is Role.OBSERVE:
                await self._station.observer_lane.turn()
            await self._websocket.send_bytes(data)

    async def receive(self, data: str | bytes) -> None:
        """Pass the packets of a message to the vehicles; a text is ignored."""
        if isinstance(data, str):
            return
        for start in range(0, len(data), SLICE):
            part = data[start : start + SLICE]
            self._pass_on(part)
            await asyncio.sleep(len(part) / RATES[self._role])

    def _pass_on(self, data: bytes) -> None:
        """Pass the packets of some bytes to the vehicles, or answer them."""
        for packet in self._packets(data):
            if not self._rules.allow(packet):
                continue
            if self._role > Role.OBSERVE or self._station.observers.passes(
                packet.message, self._connection.now()
            ):
                self._connection.forward(packet)
            elif (known := self._known_answer(packet)) is not None:
                self.queue.put(known.raw)

    def _known_answer(self, packet: Packet) -> Packet | None:
        """Return the latest message that a request asks for, which the station received before."""
        request = packet.message
        if not isinstance(request, common.CommandLong) or not 0 <= request.param1 < _IDS:
            return None
        if request.command != common.MavCmd.REQUEST_MESSAGE:
            return None
        found = self._station.packets.latest.find(request.target_system, int(request.param1))
        return None if found is None else found.packet
