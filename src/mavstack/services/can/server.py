"""The autopilot's side of CAN over MAVLink: it forwards one bus to one client.

MAV_CMD_CAN_FORWARD starts the forwarding (param 1: the number of the bus from 1, 0 ends it). It lapses after
five seconds, so a client repeats the command each second; a later client, or another bus, replaces it.
CAN_FILTER_MODIFY limits what is forwarded to DroneCAN data types. Source: ArduPilot, AP_MAVLinkCAN.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.can.frames import CanFrame, dronecan_type, from_message, to_message
from mavstack.services.service import Event, Priority, Service

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest, CommandServer
    from mavstack.wire import Packet

#: Seconds without a command after which forwarding ends.
FORWARD_TIMEOUT: Final = 5.0
MAX_FILTERS: Final = 16
_OPERATION = common.CanFilterOp


@dataclass(frozen=True, slots=True)
class CanFrameReceived(Event):
    """A client sent a frame to a bus, whose number counts from 1."""

    bus: int
    frame: CanFrame


class CanServer(Service):
    """Forwards the buses of an autopilot.

    Args:
        local: The address of the autopilot.
        buses: The number of its buses.
    """

    handles = message_ids(common.CanFrame, common.CanfdFrame, common.CanFilterModify)

    def __init__(self, local: Address, buses: int = 1) -> None:
        super().__init__(local)
        self.buses = buses
        #: The number of the bus that is forwarded; 0: none.
        self.bus = 0
        self._client = Address(0, 0)
        self._lapses: float | None = None
        self._filter: frozenset[int] = frozenset()

    def answer(self, commands: CommandServer) -> None:
        """Answer MAV_CMD_CAN_FORWARD."""
        commands.support(common.MavCmd.CAN_FORWARD, self._forward)

    def transmit(self, bus: int, frame: CanFrame) -> None:
        """Forward a frame that was on a bus, if a client wants it."""
        if bus == self.bus and (not self._filter or dronecan_type(frame.id) in self._filter):
            system, component = self._client
            self.send(to_message(frame, bus, system, component), self._client, Priority.STREAM)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.CanFrame(bus=bus) | common.CanfdFrame(bus=bus) as message:
                if bus < self.buses:
                    self.emit(CanFrameReceived(bus + 1, from_message(message)))
            case common.CanFilterModify(bus=bus) as change:
                if bus == self.bus and self._client == (packet.system, packet.component):
                    self._change_filter(change)

    def next_timeout(self) -> float | None:
        return self._lapses

    def handle_timeout(self, now: float) -> None:
        if self._lapses is not None and now >= self._lapses:
            self._end()

    def _forward(self, request: CommandRequest) -> common.MavResult:
        number = request.command.param1
        if number == 0:
            self._end()
            return common.MavResult.ACCEPTED
        if not 1 <= number <= self.buses or number != int(number):
            return common.MavResult.FAILED
        if (int(number), request.source) != (self.bus, self._client):
            self._filter = frozenset()
        self.bus, self._client = int(number), request.source
        self._lapses = request.received_at + FORWARD_TIMEOUT
        return common.MavResult.ACCEPTED

    def _end(self) -> None:
        self.bus, self._lapses, self._filter = 0, None, frozenset()

    def _change_filter(self, change: common.CanFilterModify) -> None:
        ids = frozenset(change.ids[: min(change.num_ids, MAX_FILTERS)])
        match change.operation:
            case _OPERATION.REPLACE:
                self._filter = ids
            case _OPERATION.ADD:
                self._filter |= ids
            case _OPERATION.REMOVE:
                self._filter -= ids
