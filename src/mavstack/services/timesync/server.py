"""The time synchronisation server."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Service
from mavstack.services.timesync.client import unix_nanoseconds

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.wire import Packet


class TimesyncServer(Service):
    """The server that answers time requests; `clock` returns nanoseconds since 1970 or since boot."""

    handles = message_ids(common.Timesync)

    def __init__(self, local: Address, clock: Callable[[float], int] = unix_nanoseconds) -> None:
        super().__init__(local)
        self._clock = clock

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.Timesync(tc1=0, ts1=theirs):
                source = Address(packet.system, packet.component)
                # An answer with `tc1` 0 would be a request.
                answer = common.Timesync(
                    tc1=self._clock(now) or 1,
                    ts1=theirs,
                    target_system=source.system,
                    target_component=source.component,
                )
                self.send(answer, source)
