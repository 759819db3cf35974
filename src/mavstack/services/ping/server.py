"""The ping server."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Service

if TYPE_CHECKING:
    from mavstack.wire import Packet


class PingServer(Service):
    """The server that answers each ping request; a PING with a target is an answer itself."""

    handles = message_ids(common.Ping)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.Ping(target_system=0, target_component=0) as ping:
                source = Address(packet.system, packet.component)
                answer = common.Ping(
                    time_usec=ping.time_usec,
                    seq=ping.seq,
                    target_system=source.system,
                    target_component=source.component,
                )
                self.send(answer, source)
