"""The vehicle's side of corrections: it joins the fragments of each sender and gives the frames out."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.gnss.rtcm import RtcmFrame, RtcmFramer
from mavstack.services.addressing import Address, message_ids
from mavstack.services.rtk.fragments import FrameAssembler
from mavstack.services.service import Event, Service

if TYPE_CHECKING:
    from mavstack.wire import Packet

#: The largest number of senders whose fragments are joined at the same time; the oldest sender is dropped.
MAX_SENDERS: Final = 16


@dataclass(frozen=True, slots=True)
class CorrectionReceived(Event):
    """A whole frame whose checksum is right."""

    frame: RtcmFrame
    source: Address


class CorrectionReceiver(Service):
    """Receives GPS_RTCM_DATA, and emits `CorrectionReceived` for each frame."""

    handles = message_ids(common.GpsRtcmData)

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self._senders: OrderedDict[Address, tuple[FrameAssembler, RtcmFramer]] = OrderedDict()
        #: The number of frames received.
        self.received = 0

    @property
    def lost(self) -> int:
        """Frames of the known senders of which a fragment is missing."""
        return sum(assembler.lost for assembler, _ in self._senders.values())

    def receive(self, packet: Packet, now: float) -> bool:
        match packet.message:
            case common.GpsRtcmData() as message:
                source = Address(packet.system, packet.component)
                assembler, framer = self._senders.setdefault(source, (FrameAssembler(), RtcmFramer()))
                self._senders.move_to_end(source)
                if len(self._senders) > MAX_SENDERS:
                    self._senders.popitem(last=False)
                data = assembler.add(message)
                frames = framer.feed(data) if data else []
                for frame in frames:
                    self.received += 1
                    self.emit(CorrectionReceived(frame, source))
                return bool(frames)
        return False
