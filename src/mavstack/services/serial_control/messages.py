"""What both ends of SERIAL_CONTROL share: its size, its flags, and telling repeated and overtaken packets.

The protocol numbers nothing and acknowledges nothing: what is lost stays lost. But the same bytes, the
packet's sequence number among them, are one packet that came twice, and a sequence number that lies behind
is that of a packet which others overtook.
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

_MAX_REMEMBERED = 64
#: A sequence number that is this far ahead, of 256, is behind.
_BEHIND = 192
#: Packets overtake each other by less than this; in a longer time the number may have gone round.
_OVERTAKEN_WITHIN = 0.5


def message(
    target: Address, device: int, flags: int, data: bytes = b"", *, baudrate: int = 0, timeout: int = 0
) -> common.SerialControl:
    """A SERIAL_CONTROL; it has 70 bytes at most."""
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
    """The bytes that it carries; a count that exceeds the field is clamped."""
    return serial.data[: min(serial.count, DATA_SIZE)]


class Arrivals:
    """The packets of one source that came of late."""

    def __init__(self) -> None:
        self._seen: OrderedDict[bytes, float] = OrderedDict()
        self._newest: tuple[int, float] | None = None

    def is_copy(self, packet: Packet, now: float) -> bool:
        """Whether the very packet came before; remembers it."""
        raw = packet.raw
        before = self._seen.get(raw)
        self._seen[raw] = now
        self._seen.move_to_end(raw)
        if len(self._seen) > _MAX_REMEMBERED:
            self._seen.popitem(last=False)
        return before is not None and now - before < DUPLICATE_WINDOW

    def is_late(self, packet: Packet, now: float) -> bool:
        """Whether one that was sent later came before; remembers the newest."""
        if self._newest is not None:
            sequence, heard_at = self._newest
            if now - heard_at < _OVERTAKEN_WITHIN and (packet.sequence - sequence) % 256 >= _BEHIND:
                return True
        self._newest = packet.sequence, now
        return False
