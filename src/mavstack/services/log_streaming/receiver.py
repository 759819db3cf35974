"""The ground's side of log streaming: it acknowledges blocks and puts the log together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.log_streaming.assembler import LogAssembler
from mavstack.services.service import Event, Service

if TYPE_CHECKING:
    from mavstack.wire import Packet


@dataclass(frozen=True, slots=True)
class LogStreamData(Event):
    """Bytes to append to the log: the header or complete messages."""

    data: bytes


@dataclass(frozen=True, slots=True)
class LogStreamGap(Event):
    """Blocks were lost; the log has a dropout message there.

    Attributes:
        blocks: The number of blocks.
        offset: The size of the log before the gap, in bytes.
    """

    blocks: int
    offset: int


class LogStreamReceiver(Service):
    """Receives the log of one component.

    Args:
        local: The local address.
        target: The component that streams.
    """

    handles = message_ids(common.LoggingData, common.LoggingDataAcked)

    def __init__(self, local: Address, target: Address) -> None:
        super().__init__(local)
        self.source_filter = target
        self.assembler = LogAssembler()
        #: The numbers of received and of missing blocks.
        self.blocks = self.lost = 0

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.LoggingDataAcked(sequence=sequence) as message:
                source = Address(packet.system, packet.component)
                ack = common.LoggingAck(
                    target_system=source.system, target_component=source.component, sequence=sequence
                )
                self.send(ack, source)
                self._add(message, now)
            case common.LoggingData() as message:
                self._add(message, now)

    def _add(self, message: common.LoggingData | common.LoggingDataAcked, now: float) -> None:
        if not self.assembler.is_new(message.sequence):
            return
        offset = self.assembler.size
        data = bytes(message.data[: message.length])
        found = self.assembler.add(message.sequence, data, message.first_message_offset, now)
        self.blocks += self.assembler.has_started
        if found.lost:
            self.lost += found.lost
            self.emit(LogStreamGap(found.lost, offset))
        if found.data:
            self.emit(LogStreamData(found.data))
