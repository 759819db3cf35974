"""Packets of the table of cases, with sequence numbers as a link carries them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.wire import Encoder, crc16

if TYPE_CHECKING:
    from .cases import Step

UNKNOWN_ID = 50_000
#: Any byte makes the checksum of an unknown message valid.
CRC_EXTRA = 77


class Packets:
    """Creates the packet of each step."""

    def __init__(self) -> None:
        self._sequence = 0
        self._last = b""

    def make(self, step: Step) -> bytes:
        """Return the bytes of a step."""
        if not step.copy:
            encoder = Encoder(*step.source, version=step.version)
            for _ in range(self._sequence):
                encoder.encode(common.Heartbeat())
            self._sequence += 1
            self._last = encoder.encode(step.message) if step.message is not None else unknown(encoder)
        return self._last


def unknown(encoder: Encoder) -> bytes:
    """Return a packet whose message no dialect has."""
    raw = bytearray(encoder.encode(common.Attitude(roll=1.0)))
    raw[7:10] = UNKNOWN_ID.to_bytes(3, "little")
    raw[-2:] = crc16(bytes([CRC_EXTRA]), crc16(raw[1:-2])).to_bytes(2, "little")
    return bytes(raw)
