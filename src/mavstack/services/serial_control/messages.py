"""The shared part of both ends of SERIAL_CONTROL: its size, its flags, and duplicate and reordered packets.

The protocol has no numbers and no acknowledgements: lost data stays lost. But equal bytes, sequence number
included, are a duplicated packet, and a lower sequence number is that of a reordered packet.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.timing import DUPLICATE_WINDOW

if TYPE_CHECKING:
    from mavstack.services.addressing import Address
    from mavstack.wire import Packet

DATA_SIZE = 70
SHELL = common.SerialControlDev.DEV_SHELL
REPLY = int(common.SerialControlFlag.REPLY)
RESPOND = int(common.SerialControlFlag.RESPOND)
EXCLUSIVE = int(common.SerialControlFlag.EXCLUSIVE)
MULTI = int(common.SerialControlFlag.MULTI)

_MAX_TRACKED = 64
#: A sequence number that is ahead by this much or more, modulo 256, is an older one.
_BEHIND = 192
#: Seconds within which packets may be reordered; later the sequence number may have wrapped.
_REORDER_WINDOW = 0.5


def message(
    target: Address, device: int, flags: int, data: bytes = b"", *, baudrate: int = 0, timeout: int = 0
) -> common.SerialControl:
    """Return a SERIAL_CONTROL with up to 70 bytes."""
    return common.SerialControl(
        device=device,
        flags=flags,
        timeout=timeout,
        baudrate=baudrate,
        count=len(data),
        data=data,
        target_system=target.system,
        target_component=target.component,
    )


def data_of(serial: common.SerialControl) -> bytes:
    """Return the bytes of a SERIAL_CONTROL; a count beyond the field is clamped."""
    return serial.data[: min(serial.count, DATA_SIZE)]


class ArrivalTracker:
    """The recent packets of one source."""

    def __init__(self) -> None:
        self._seen: OrderedDict[bytes, float] = OrderedDict()
        self._newest: tuple[int, float] | None = None

    def is_copy(self, packet: Packet, now: float) -> bool:
        """Return whether the packet is a duplicate; records it."""
        raw = packet.raw
        before = self._seen.get(raw)
        self._seen[raw] = now
        self._seen.move_to_end(raw)
        if len(self._seen) > _MAX_TRACKED:
            self._seen.popitem(last=False)
        return before is not None and now - before < DUPLICATE_WINDOW

    def is_late(self, packet: Packet, now: float) -> bool:
        """Return whether a newer packet arrived before; records the newest."""
        if self._newest is not None:
            sequence, received_at = self._newest
            if now - received_at < _REORDER_WINDOW and (packet.sequence - sequence) % 256 >= _BEHIND:
                return True
        self._newest = packet.sequence, now
        return False
