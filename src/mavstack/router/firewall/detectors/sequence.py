"""Sequence anomalies: two senders that share an address on one link.

The sequence numbers of one sender increase; packets that are lost leave gaps, and reordering makes a few
steps back. Two senders that count for themselves make many steps back. This detector sees every packet.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.router.firewall.detector import Detector, make_room
from mavstack.services import Address

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.router.config import Table
    from mavstack.router.firewall.alerts import Alert
    from mavstack.wire import Packet

#: Number of packets of a sender per check, and number of steps back among them that is normal.
WINDOW: Final = 64
DEFAULT_MAX_STEPS_BACK: Final = 10
MAX_SENDERS: Final = 4096
#: Half of the sequence numbers: a smaller difference means lost packets, a larger one a step back.
_HALF: Final = 128


@dataclass(slots=True)
class _Sender:
    sequence: int
    packets: int = 0
    steps_back: int = 0


class SequenceAnomalies(Detector):
    """Reports an address whose sequence numbers jump back and forth; the packets pass."""

    name: ClassVar[str] = "sequence"
    every_packet: ClassVar[bool] = True

    def __init__(self) -> None:
        self.max_steps_back = DEFAULT_MAX_STEPS_BACK
        self._senders: dict[tuple[str, Address], _Sender] = {}

    def configure(self, options: Table) -> None:
        """Read the options of the detector."""
        self.max_steps_back = options.value("max_steps_back", int, self.max_steps_back)

    def inspect(self, origin: str, packet: Packet, now: float) -> Iterator[Alert]:
        """Yield the alerts about a packet."""
        key = (origin, Address(packet.system, packet.component))
        sender = self._senders.get(key)
        if sender is None:
            make_room(self._senders, MAX_SENDERS)
            self._senders[key] = _Sender(packet.sequence)
            return
        step = (packet.sequence - sender.sequence) % 256
        sender.sequence = packet.sequence
        sender.packets += 1
        sender.steps_back += step == 0 or step > _HALF
        if sender.packets >= WINDOW:
            if sender.steps_back > self.max_steps_back:
                text = f"{sender.steps_back} of {WINDOW} sequence numbers step back: two senders?"
                yield self.alert(origin, packet, text, refuse=False)
            sender.packets = sender.steps_back = 0
